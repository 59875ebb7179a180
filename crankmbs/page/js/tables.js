/** What of the crank train depends on the angle alone: reduced inertia and torque.
 *
 *     J = J_crank + sum of  m_p x1^2 + m_r (gx1^2 + gy1^2) + I_r beta1^2
 *
 * over the cylinders, with the rod's centre of mass g = (r cos(phi) + a cos(beta), r sin(phi) - a
 * sin(beta)).
 */
import { appliedAt } from "./applied.js";
import { distinct, repeated } from "./arrays.js";
import { knotsOver, valueAt } from "./cubics.js";
import { ringTorque } from "./friction.js";
import { torqueOverAngle } from "./loads.js";

const WIDEST = (6 * Math.PI) / 180;
const SLIVER = 1e-12; // rad: two edges closer than this are one
const NOTHING = []; // thousands of nodes share it
const WEIGHTLESS = [0, 0];
const ONE = pushColumns(1, massColumns(1)); // the place of a single angle

/** Gravity [m/s2] in the frame of a cylinder at this bank [rad]. */
export function gravityVector(gravity, bank) {
  if (gravity === null) return WEIGHTLESS;
  const angle = gravity.angle - bank;
  return [gravity.acceleration * Math.cos(angle), gravity.acceleration * Math.sin(angle)];
}

/** The crank train at one crank angle [rad]: inertia J [kg m2] with the crank's, slope dJ/dtheta,
 * torque of gas, weights and forces on the pistons [N m], what the combustion of each cylinder adds
 * to it, and of friction the torque of each cylinder's gas where that presses rings, what rings
 * oppose to either sense of rotation without it [N m], and drag, torque per speed [N m s/rad]. */
export function reduceAt(train, theta) {
  const of = movingAt(train, theta);
  of.inertia += train.crank.inertia;
  return of;
}

/** The same without the crank's inertia. */
export function movingAt(train, theta) {
  const row = rowOf(train, theta);
  train.cylinders.forEach(({ phase }, k) => {
    fillMasses(train, k, theta + phase, ONE.masses, 0);
    fillPushes(train, k, theta + phase, ONE, 0);
    addCylinder(row, k, ONE, 0);
  });
  return row;
}

/** The row of the crank alone at an angle, to which cylinders are added. */
export function rowOf({ crank, cylinders, gravity, friction, pressure, firing }, theta) {
  const each = (there) => (there ? cylinders.map(() => 0.5) : NOTHING);
  return {
    theta, inertia: 0, slope: 0, torque: crankWeight(crank, gravity, theta), rings: 0, drag: 0,
    gas: each(friction?.ring_pressure && pressure.length), combustion: each(firing.length),
  };
}

/** Add cylinder k with what stands at place n of its columns. */
export function addCylinder(row, k, pushes, n) {
  const { masses } = pushes;
  const at = n % masses.x.length;
  row.inertia += masses.inertia[at];
  row.slope += masses.slope[at];
  row.torque += masses.weight[at] + pushes.torque[n];
  row.rings += pushes.rings[n];
  row.drag += pushes.drag[n];
  if (row.gas.length) row.gas[k] = pushes.gas[n];
  if (row.combustion.length) row.combustion[k] = pushes.combustion[n];
}

/** Columns of so many numbers, for masses as `fillMasses` writes them. */
export function massColumns(count) {
  return columns(["x", "x1", "inertia", "slope", "weight"], count);
}

/** The same for what pushes a piston, in a number of turns; masses : those of a turn. */
export function pushColumns(count, masses) {
  return { masses, ...columns(["torque", "gas", "combustion", "rings", "drag"], count) };
}

function columns(names, count) {
  const all = new Float64Array(names.length * count); // quicker than one by one
  return Object.fromEntries(names.map((name, k) =>
    [name, all.subarray(k * count, (k + 1) * count)]));
}

/** Write at place n what pushes the piston of cylinder k at a cycle angle [rad] does to the crank:
 * torque of gas and forces, that of the gas alone and what combustion adds, rings and drag. */
export function fillPushes({ gears, friction, pressure, firing }, k, phi, to, n) {
  const { piston, drag } = gears[k];
  const { masses } = to;
  const at = n % masses.x.length;
  const x1 = masses.x1[at];
  const lever = -piston.area * x1;
  const gas = pressure.length ? lever * valueAt(pressure[k], phi) : 0;
  const { steady, jumping } = appliedAt(gears[k], phi, masses.x[at], x1);
  to.torque[n] = gas - x1 * steady;
  to.gas[n] = gas;
  to.combustion[n] = firing.length ? lever * valueAt(firing[k], phi) - gas : 0;
  to.rings[n] = Math.abs(x1) * ((friction?.ring_force ?? 0) + jumping);
  to.drag[n] = drag * x1 * x1;
}

/** Write at place n what the masses of cylinder k are at a cycle angle [rad]: its share of inertia
 * and slope, and the torque of its weights; with the piston's position and its derivative. */
export function fillMasses({ gears, cylinders, gravity }, k, phi, to, n) {
  const { rod, piston, loop } = gears[k];
  const at = loop.at(phi);
  const g = rodCentre(at, rod.center_of_mass);
  to.x[n] = at.x;
  to.x1[n] = at.x1;
  to.inertia[n] = piston.mass * at.x1 * at.x1 + rod.mass * (g.x1 * g.x1 + g.y1 * g.y1) +
    rod.inertia * at.beta1 * at.beta1;
  to.slope[n] = 2 * (piston.mass * at.x1 * at.x2 + rod.mass * (g.x1 * g.x2 + g.y1 * g.y2)) +
    2 * rod.inertia * at.beta1 * at.beta2;
  const [ax, ay] = gravityVector(gravity, cylinders[k].bank);
  to.weight[n] = piston.mass * ax * at.x1 + rod.mass * (ax * g.x1 + ay * g.y1);
}

/** Torque of gas, weights, friction and loads over the angle [N m] at an angle that is reduced, at
 * a speed; shares of the combustion and phases of the loads : of a motion in a sense. */
export function givenAt({ friction, loads }, of, { shares, phases, sense }, omega) {
  const rings = ringTorque(friction, of, shares);
  const over = torqueOverAngle(loads, phases, of.theta);
  return of.torque + burnt(of.combustion, shares) + over - sense * rings - of.drag * omega;
}

/** The same less J' omega^2 / 2: with the other loads it accelerates the crank [N m]. */
export function unloadedAt(train, of, state, omega) {
  return givenAt(train, of, state, omega) - 0.5 * of.slope * omega * omega;
}

/** Torque of the crank's own weight at a crank angle [N m]. */
function crankWeight(crank, gravity, theta) {
  if (gravity === null) return 0;
  const [gx, gy] = gravityVector(gravity, 0);
  const first = crank.mass * crank.center_of_mass;
  return first * (gy * Math.cos(theta) - gx * Math.sin(theta));
}

/** What the combustion adds with these shares [N m]. */
function burnt(combustion, shares) {
  let sum = 0;
  for (let k = 0; k < combustion.length; k++) sum += shares[k] * combustion[k];
  return sum;
}

/** First and second derivatives of the rod's centre of mass in the cycle angle [m]. */
export function rodCentre(at, a) {
  const { radius: r, sinPhi, cosPhi, sinBeta, cosBeta, beta1, beta2 } = at;
  return {
    x1: -r * sinPhi - a * sinBeta * beta1,
    y1: r * cosPhi - a * cosBeta * beta1,
    x2: -r * cosPhi - a * (cosBeta * beta1 * beta1 + sinBeta * beta2),
    y2: -r * sinPhi - a * (cosBeta * beta2 - sinBeta * beta1 * beta1),
  };
}

/** The edges of the cells of one period [rad]: at the knots of pressures and of loads over the
 * angle, at decisions on the fuel and around folds, no cell wider than so many.
 *
 * cycles : over the cycle angle, of one cylinder after the other, and so on
 * marks : knots [rad], of cycles over the crank angle and decisions
 */
export function edgesOf(shapes, cylinders, cycles, marks, period, widest = WIDEST) {
  const found = [0, period];
  shapes.forEach((shape, k) => found.push(...nearFolds(shape, cylinders[k], period)));
  for (const each of marks) for (const mark of each) found.push(mark);
  cycles.forEach((cycle, k) => {
    const { phase } = cylinders[k % cylinders.length];
    for (const knot of knotsOver(cycle, phase, period)) found.push(knot);
  });
  const edges = distinct(found, SLIVER);
  edges[edges.length - 1] = period;
  const parts = (k) => Math.max(Math.ceil((edges[k + 1] - edges[k]) / widest - 1e-9), 1);
  return split(edges, Array.from({ length: edges.length - 1 }, (_, k) => parts(k)));
}

/** Every cell cut into equal parts, as many as `parts` says. */
export function split(edges, parts) {
  const found = [];
  parts.forEach((count, k) => {
    const width = (edges[k + 1] - edges[k]) / count;
    for (let part = 0; part < count; part++) found.push(edges[k] + part * width);
  });
  found.push(edges[edges.length - 1]);
  return Float64Array.from(found);
}

/** Crank angles around those where a rod is hardly longer than it must be, ever farther: it swings
 * over there so fast that wider cells would not see it. */
function nearFolds({ radius, length, offset }, { phase }, period) {
  const marks = [];
  for (const [fold, gap] of [[0.5, length - radius + offset], [-0.5, length - radius - offset]]) {
    const width = Math.sqrt((2 * Math.max(gap, 0)) / radius);
    if (!(width > 0 && width < WIDEST)) continue;
    const around = [0];
    for (let far = width; far < WIDEST; far *= 2) around.push(-far, far);
    marks.push(...repeated(around.map((each) => fold * Math.PI - phase + each), period));
  }
  return marks;
}
