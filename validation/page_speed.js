/** What a turned knob costs the page's engine. */
import { Engine } from "./engine.js";
import { valuesOf } from "./given.js";
import { reactionsAt } from "./reactions.js";

/** Values as Python wrote them. */
export function decoded(text) {
  return valuesOf(JSON.parse(text));
}

/** One engine for many scenes. */
export function engineOf(rules) {
  return new Engine(decoded(rules));
}

/** Milliseconds that a scene takes as a knob moves: pressures and cells, tables and motion, samples
 * with every reaction. */
export function timed(engine, scene) {
  const marks = [performance.now()];
  const train = engine.train(scene, true);
  engine.edgesFor(train, scene.grid_period, true);
  marks.push(performance.now());
  const motion = engine.run(scene);
  marks.push(performance.now());
  const { from, to } = motion;
  for (let k = 0; k <= 360; k++) {
    reactionsAt(motion.train, motion.at(from + ((to - from) * k) / 360));
  }
  marks.push(performance.now());
  return marks.slice(1).map((mark, k) => mark - marks[k]);
}
