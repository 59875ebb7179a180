/** Torques from outside on the free crank, and when each acts.
 *
 * A load comes from Python as its parts: a function of time, one of the crank speed, each of
 * parabolas between knots, and a cycle over the crank angle. On a stretch without a kink the sum
 * over time and speed is one branch,
 *
 *     T = c0 + ct t + c1 omega + c2 omega^2,
 *
 * which holds up to the time tEnd, from the speed low to the speed high.
 */
import { countUpTo } from "./arrays.js";
import { valueAt } from "./cubics.js";

// of one load: its speed is not met; it waits for its time; it acts; it is over
const [WAITING, DUE, ACTING, OVER] = [0, 1, 2, 3];

/** The phases of the loads at time 0. */
export function firstPhases(loads, omega) {
  return laterPhases(loads, loads.map(() => WAITING), 0, omega);
}

/** The phases after landing at a time [s] and a speed [rad/s], which must be met exactly. */
export function laterPhases(loads, phases, t, omega) {
  return phases.map((phase, k) => laterPhase(loads[k], phase, t, omega));
}

function laterPhase(load, phase, t, omega) {
  if (load.until !== null && t >= load.until) return OVER;
  if (phase === ACTING) return omega === load.until_speed ? OVER : ACTING;
  if (phase === WAITING && (load.from_speed === null || load.from_speed === omega)) phase = DUE;
  return phase === DUE && t >= (load.after ?? 0) ? ACTING : phase;
}

/** Torque of the acting loads over the crank angle [N m]. */
export function torqueOverAngle(loads, phases, theta) {
  let torque = 0;
  for (let k = 0; k < loads.length; k++) {
    const { over_angle: cycle } = loads[k];
    if (cycle && phases[k] === ACTING) torque += valueAt(cycle, theta);
  }
  return torque;
}

/** Torque of a branch [N m]. */
export function torqueOf(branch, t, omega) {
  return branch.c0 + branch.ct * t + (branch.c1 + branch.c2 * omega) * omega;
}

/** The branch that the motion enters.
 *
 * rest [N m] : torque of all else minus J1 omega^2 / 2; with a load's torque added its sign is that
 * of the acceleration. null where a jump drives the speed back from both sides.
 */
export function branchAt(loads, phases, t, omega, rest) {
  const above = branchBeside(loads, phases, t, omega, true);
  const below = branchBeside(loads, phases, t, omega, false);
  const push = torqueOf(above, t, omega);
  const pull = torqueOf(below, t, omega);
  if (rest + push > 0) return above;
  if (rest + pull < 0) return below;
  const jumps = pull - push > 1e-12 * Math.max(Math.abs(pull), Math.abs(push));
  return jumps ? null : above;
}

/** The smooth stretch that begins at (t, omega); on a knot in the speed that above if `rising`. */
function branchBeside(loads, phases, t, omega, rising) {
  const branch = { c0: 0, ct: 0, c1: 0, c2: 0, tEnd: Infinity, low: -Infinity, high: Infinity };
  loads.forEach((load, k) => {
    boundByPhase(branch, load, phases[k], t, omega, rising);
    if (phases[k] !== ACTING) return;
    if (load.over_time) addOverTime(branch, load.over_time, t);
    if (load.over_speed) addOverSpeed(branch, load.over_speed, omega, rising);
  });
  return branch;
}

/** End the branch at the times and speeds at which a load's phase may end. */
function boundByPhase(branch, load, phase, t, omega, rising) {
  const time = { [DUE]: load.after, [ACTING]: load.until }[phase] ?? null;
  if (time !== null && time > t) branch.tEnd = Math.min(branch.tEnd, time);
  const speed = { [WAITING]: load.from_speed, [ACTING]: load.until_speed }[phase] ?? null;
  if (speed === null) return;
  if (speed > omega || (speed === omega && !rising)) branch.high = Math.min(branch.high, speed);
  else branch.low = Math.max(branch.low, speed);
}

function addOverTime(branch, { knots, pieces }, t) {
  const k = countUpTo(knots, t);
  branch.c0 += pieces[3 * k];
  branch.ct += pieces[3 * k + 1];
  if (k < knots.length) branch.tEnd = Math.min(branch.tEnd, knots[k]);
}

function addOverSpeed(branch, { knots, pieces }, omega, rising) {
  let k = countUpTo(knots, omega);
  if (!rising && k > 0 && knots[k - 1] === omega) k--;
  branch.c0 += pieces[3 * k];
  branch.c1 += pieces[3 * k + 1];
  branch.c2 += pieces[3 * k + 2];
  if (k > 0) branch.low = Math.max(branch.low, knots[k - 1]);
  if (k < knots.length) branch.high = Math.min(branch.high, knots[k]);
}

/** Whether the torque is c0 + c2 omega^2: then dE/dtheta is linear in E. */
export function isAffine(branch) {
  return branch.ct === 0 && branch.c1 === 0;
}
