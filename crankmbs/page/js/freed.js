/** A prescribed speed's crank set free: a constant load that balances it, at the mean speed it had.
 *
 * Over a period the load takes what gas, weights and friction give, T = -W / angle. Then E = E_0 +
 * (E - E_0)(theta) is the same at every speed, and E_0 the one with which a period takes as long as
 * at the mean speed. What viscous friction takes depends on the motion: load and E_0 are then
 * sought together, period by period.
 */
import { AffinePeriod } from "./affine.js";
import { eliminate } from "./arrays.js";
import { lastSpan } from "./measures.js";
import { Section, settle } from "./settled.js";
import { speedLaw } from "./speed.js";

const ROUNDS = 40;
const CLOSE = 1e-13; // relative, of gain and duration

/** A scene of a prescribed speed with its crank free; it is given its load when it is run. */
export function setFree(scene) {
  const { motion, run, period } = scene;
  const start = { angle: motion.angle, speed: meanPrescribed(motion, run, period) };
  return { ...scene, motion: null, start, freed: true, run: { ...run, settled: true } };
}

/** Mean of a prescribed speed [rad/s], angle over time, over the last whole cycle of its run. */
function meanPrescribed(motion, { until, in_time: inTime }, period) {
  const law = speedLaw(motion);
  const to = inTime ? law.at(until)[0] : motion.angle + Math.sign(law.at(0)[1]) * until;
  const { from } = lastSpan(motion.angle, to, period);
  return (to - from) / ((inTime ? until : law.timeAt(to)) - law.timeAt(from));
}

/** What a machine with the load that balances it settles to at the mean speed of a start { angle,
 * speed }, as `settle` gives it: ending "complete", "light" where it comes near rest, or
 * "wanders" where none is found. */
export function settleFree(train, grid, start) {
  const sense = Math.sign(start.speed);
  const even = evenly(train, grid, start.speed);
  const torque = balance(even, start, sense);
  const loaded = (load) => ({ ...train, loads: [constant(load)] });
  const found = settle({ ...even.train, loads: [constant(torque)] }, even.grid, start, null);
  if (even.train === train) {
    const ending = found.ending === "complete" ? "complete" : "light";
    return { ...found, train: loaded(torque), ending };
  }
  return withDrag({ grid, start, sense, loaded }, torque, found.motion);
}

/** Machine and grid whose drag is what it would be at a constant speed [rad/s]. */
function evenly(train, grid, speed) {
  if (train.gears.every(({ drag }) => drag === 0)) return { train, grid };
  const at = (n) => {
    const of = grid.nodes.at(n);
    return { ...of, torque: of.torque - of.drag * speed, drag: 0 };
  };
  const gears = train.gears.map((gear) => ({ ...gear, drag: 0 }));
  return { train: { ...train, gears }, grid: { ...grid, nodes: { ...grid.nodes, at } } };
}

/** The constant load [N m] under which a period gains nothing. */
function balance({ train, grid }, start, sense) {
  const section = new Section(train, grid, start, sense);
  const { whole } = new AffinePeriod(section, section.affineBranch(start.speed));
  return (-sense * whole.rise) / section.period;
}

/** Energy at the begin and load such that a period gains nothing and takes the time it must, by
 * Broyden's method: from those of the motion in which friction is even, whose duration changes with
 * the energy by `slope`. Both are counted in joules, the load by its work. Of the energy a period
 * leaves the factor, and half of the load's work is done on average. */
function withDrag({ grid, start, sense, loaded }, torque, { path, slope }) {
  const even = path.cells[0].energy;
  let [at, step, jacobian] = [[even, 0], null, null];
  for (let n = 0; n < ROUNDS; n++) {
    const train = loaded(torque + (sense * at[1]) / grid.edges[grid.edges.length - 1]);
    const section = new Section(train, grid, start, sense);
    const shot = section.shot(at[0]);
    if (shot.ending !== "complete") return { train, ending: "light" };
    const gained = shot.energy - at[0];
    const late = shot.time - section.period / Math.abs(start.speed);
    if (Math.abs(gained) <= CLOSE * at[0] && Math.abs(late) <= CLOSE * shot.time) {
      return section.found("complete", shot, { factor: shot.factor });
    }
    const off = [gained, late / slope];
    const bent = (each, k) =>
      each + (off[k >> 1] * step[k & 1]) / (step[0] ** 2 + step[1] ** 2);
    jacobian = jacobian?.map(bent) ?? Float64Array.of(shot.factor - 1, 1, 1, 0.5);
    step = off.map((each) => -each);
    eliminate(jacobian.slice(), step, 2, 1);
    at = at.map((each, k) => each + step[k]);
  }
  return { train: loaded(torque), ending: "wanders" };
}

/** A constant load [N m]. */
function constant(torque) {
  return {
    over_time: { knots: new Float64Array(0), pieces: Float64Array.of(torque, 0, 0) },
    over_speed: null, over_angle: null,
    after: null, until: null, from_speed: null, until_speed: null,
  };
}
