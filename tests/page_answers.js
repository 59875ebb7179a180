/** What tests ask of the page's engine: a scene in, all numbers of its motion out. */
import { pressuresOf } from "./gas.js";
import { Engine } from "./engine.js";
import { setFree } from "./freed.js";
import { valuesOf } from "./given.js";
import { LECTURES, lecturedAt } from "./lecture.js";
import { lastSpan, measuresOf } from "./measures.js";
import { reactionsAt } from "./reactions.js";
import { Track } from "./track.js";

const FINE = { stages: 7, tolerance: 1e-12 };

/** Values as Python wrote them. */
export function decoded(value) {
  return valuesOf(value);
}

/** One engine for many scenes. */
export function engineOf(rules) {
  return new Engine(decoded(rules));
}

/** How the motion of a scene ends, and if well its variables at crank angles, each a list, those of
 * the cylinders a list of lists, and its measures over the last cycle. */
export function answer(engine, { scene, angles }) {
  const motion = engine.run(scene, FINE);
  const { ending, factor = null, balanced = false } = motion;
  if (ending !== "complete") return { ending };
  const samples = Array.from(angles, (theta) => reactionsAt(motion.train, motion.at(theta)));
  const span = lastSpan(angles[0], angles[angles.length - 1], ...scene.periods);
  const measures = measuresOf(motion, engine.rules[9], span);
  return { ending, factor, balanced, variables: columns(samples), measures };
}

/** The same of a scene of a prescribed speed that is set free, and the load that balances it. */
export function freeing(engine, { scene, angles }) {
  const free = setFree(scene);
  const found = answer(engine, { scene: free, angles });
  if (found.ending !== "complete") return found;
  const { train, from } = engine.run(free, FINE);
  return { ...found, torque: train.loads[0].over_time.pieces[0], speed: free.start.speed, from };
}

/** The variables of a scene at crank angles as they are shown while a knob moves. */
export function dragged(engine, { scene, angles }) {
  const motion = engine.run(scene);
  if (motion.ending !== "complete") return { ending: motion.ending };
  return columns(Array.from(angles, (theta) => reactionsAt(motion.train, motion.at(theta))));
}

/** The quantities of a lecture, by its name, at samples of a scene's motion. */
export function lectured(engine, { scene, lecture, samples }) {
  const train = engine.train(scene);
  return columns(samples.map((each) => lecturedAt(train, LECTURES[lecture], each)));
}

function columns(samples) {
  const { cylinders, ...crank } = samples[0];
  const found = {};
  for (const name of Object.keys(crank)) found[name] = samples.map((each) => each[name]);
  for (const name of Object.keys(cylinders[0])) {
    found[name] = samples.map((each) => each.cylinders.map((one) => one[name]));
  }
  return found;
}

/** The pressures of a scene in a machine of another shape, without and with combustion, as lists. */
export function carried(_, { scene, shape }) {
  const { crank_end_share: share } = scene.piston;
  const { pressure, firing, crank_end } = pressuresOf(scene.gas, shape, share);
  const plain = ({ knots, coefficients }) => [Array.from(knots), Array.from(coefficients)];
  const [made, more, below] = [pressure, firing, crank_end].map((each) => each.map(plain));
  return { pressure: made, firing: more, crank_end: below };
}

/** A run as the page replays it, at times [s]: the time, angle and speed that are shown there, the
 * share of the fuel, and where the pistons are under which pressures. */
export function replayed(_, { film, times }) {
  const track = new Track(film);
  return columns(Array.from(times, (time) => {
    const at = track.shown(time);
    const { angle, speed } = track.to(at);
    return { time: at, angle, speed, fuel: track.fuelAt(at), ...track.at(angle) };
  }));
}
