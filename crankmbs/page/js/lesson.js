/** A lesson: its figures, of which the one that is seen plays, and its questions. */
import { Figure } from "./figure.js";
import { valuesOf } from "./given.js";
import { Turner } from "./turned.js";

const SEEN = 0.6; // of a figure's board
const NUMBER = /^([+-]?(?:\d+[.,]?\d*|[.,]\d+)(?:e[+-]?\d+)?)\s*(.*)$/i;

/** Begin with what Python wrote into the page. figures : what each computes, by its name */
export function begun(figures) {
  const given = valuesOf(JSON.parse(document.getElementById("given").textContent));
  const lesson = { given, turner: new Turner(given) };
  const made = given.figures.map((spec) =>
    new Figure(document.getElementById(spec.name), lesson, spec, figures[spec.name]));
  const watch = new IntersectionObserver((entries) => {
    for (const { target, intersectionRatio } of entries) {
      made.find(({ root }) => root.contains(target)).seen(intersectionRatio >= SEEN);
    }
  }, { threshold: [0, SEEN] });
  for (const { root } of made) watch.observe(root.querySelector(".board"));
  for (const question of given.questions) {
    asked(document.getElementById(question.name), question);
  }
  return made;
}

/** What a typed answer, in the unit shown or with its own, is worth: { verdict, text }, the verdict
 * "right", "wrong" or "unclear"; what is near is not yet right.
 *
 * question : { values that are right in `unit`, unit, tolerance relative, units, hint }, with units
 * that may be typed, each by its factor to `unit`
 */
function judged(typed, { values, unit, tolerance, units, hint }) {
  const match = NUMBER.exec(typed.trim().replace(/[\u2212\u2013]/g, "-"));
  const shown = unit && `\u00a0${unit}`;
  if (!match) return { verdict: "unclear", text: `A number, please, such as 1.5${shown}.` };
  const factor = match[2] ? units[plain(match[2])] : 1;
  if (factor === undefined) {
    const wanted = unit ? `in ${unit}` : "by a number without a unit";
    return { verdict: "unclear", text: `“${match[2]}” does not fit here: answer ${wanted}.` };
  }
  const found = Number(match[1].replace(",", ".")) * factor;
  const awayOf = (number) => Math.min(...values.map((value) => Math.abs(number / value - 1)));
  const off = awayOf(found);
  if (off <= tolerance) return { verdict: "right", text: "Right." };
  if (unit === "%" && !match[2] && awayOf(100 * found) <= tolerance) {
    return { verdict: "unclear", text: "In %, please." };
  }
  return { verdict: "wrong", text: off <= 5 * tolerance ? `Close, but not there. ${hint}` : hint };
}

/** A unit without what may be written one way or the other. */
function plain(unit) {
  return unit.replace(/[\s^*·]/g, "").replace("²", "2").replace("deg", "°");
}

/** Listen to a question's field and button. */
function asked(root, question) {
  const [field, button] = [root.querySelector("input"), root.querySelector("button")];
  const reply = root.querySelector(".reply");
  const check = () => {
    const { verdict, text } = judged(field.value, question);
    reply.textContent = text;
    reply.className = `reply ${verdict}`;
    if (verdict === "right") root.querySelector("details").open = true;
  };
  button.addEventListener("click", check);
  field.addEventListener("keydown", (event) => event.key === "Enter" && check());
}
