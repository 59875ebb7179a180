/** A lesson: its figures, of which the one that is seen plays, and its questions. */
import { Figure } from "./figure.js";
import { valuesOf } from "./given.js";
import { asked } from "./question.js";
import { Turner } from "./turned.js";

const SEEN = 0.6; // of a figure's board

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
