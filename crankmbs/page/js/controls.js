/** The page's choices and words: selects, measures, badge. */
import { isShape } from "./gas.js";
import { find } from "./keys.js";
import { choices } from "./quantities.js";
import { build, listed, set, write } from "./svg.js";
import { spanOf } from "./view.js";
import { badgeOf, numbersOf, trustOf } from "./words.js";

let shownAs = ""; // the choices that stand there, as text

/** What a plot can show of a scene, as options. */
export function fillChoices(select, scene) {
  for (const [label, names] of Object.entries(choices(scene))) {
    const group = build(select, "optgroup");
    Object.assign(group, { label }).append(...names.map((each) => new Option(each, each)));
  }
}

/** Listen to the choices; chosen(name, value), undefined for what the scene has itself. */
export function listenToChoices(chosen) {
  for (const select of document.querySelectorAll("select[data-state]")) {
    select.addEventListener("change", () => {
      const { state, own } = select.dataset;
      chosen(state, select.value === own ? undefined : select.value);
    });
  }
}

/** Show the choices of a state, { name: word }, and the ends of a cycle. */
export function showChoices(given, cycle, state) {
  const { low, high } = spanOf(cycle);
  const words = Object.values(state).filter((value) => typeof value === "string");
  const as = JSON.stringify([words, low, high, cycle.train.cylinders.length]);
  if (as === shownAs) return;
  shownAs = as;
  find("cylinder").replaceChildren(...cycle.train.cylinders.map((_, k) =>
    new Option(`cylinder ${k + 1}`, String(k + 1))));
  for (const select of document.querySelectorAll("select[data-state]")) {
    select.value = state[select.dataset.state];
  }
  find("cylinder").hidden = cycle.train.cylinders.length < 2;
  Object.assign(find("angle"), { min: low, max: high });
}

/** Measures, badge, and whether the pressure was carried over. error : of the quick pass */
export function showWords(given, cycle, error) {
  const all = numbersOf(cycle);
  write(find("trust"), trustOf(cycle, error));
  const items = listed(find("numbers"), all.length, ["div"], ["dt", "dd"]);
  all.forEach((words, n) => words.forEach((text, k) => write(items[n].children[k], text)));
  const { text, good } = badgeOf(cycle, given.endings);
  write(find("badge"), text);
  set(find("badge"), { class: good ? "good" : "drifts" });
  const own = given.scene.gas?.shape;
  find("carried").toggleAttribute("hidden", !own || isShape(cycle.train.shape, own));
}

/** Say a sentence in the place of the badge, or none. stale : whether the picture is another one
 * than the knobs say */
export function say(sentence, stale = false) {
  write(find("message"), sentence);
  find("message").toggleAttribute("hidden", sentence === "");
  find("badge").toggleAttribute("hidden", sentence !== "");
  document.body.classList.toggle("stale", stale);
}

/** Unfold all that the page has, or fold it to what it begins with; else the other of both. */
export function unfold(all = find("more").getAttribute("aria-expanded") === "false") {
  document.documentElement.classList.toggle("full", all);
  set(find("more"), { "aria-expanded": String(all) });
  write(find("more"), all ? "show less" : "show all");
}

/** The plots that are seen: of what the page begins with, the upper. */
export function seenPlots() {
  const all = document.documentElement.classList.contains("full");
  return all ? ["upper", "lower"] : ["upper"];
}
