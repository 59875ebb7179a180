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
  const { crank, cylinders, gravity, friction, pressure, firing } = train;
  const gas = friction?.ring_pressure && pressure.length ? [] : NOTHING;
  const burning = firing.length ? [] : NOTHING;
  let [inertia, slope, rings, drag] = [0, 0, 0, 0];
  let torque = crankWeight(crank, gravity, theta);
  for (let k = 0; k < cylinders.length; k++) {
    const phi = theta + cylinders[k].phase;
    const masses = massesAt(train, k, phi);
    const push = pushAt(train, k, phi, masses.x, masses.x1);
    inertia += masses.inertia;
    slope += masses.slope;
    torque += masses.weight + push.torque;
    rings += push.rings;
    drag += push.drag;
    if (gas !== NOTHING) gas.push(push.gas);
    if (burning !== NOTHING) burning.push(push.combustion);
  }
  return { theta, inertia, slope, torque, combustion: burning, gas, rings, drag };
}

/** What pushes the piston of cylinder k at a cycle angle [rad] does to the crank: torque of gas and
 * forces, that of the gas alone and what combustion adds, rings and drag. */
export function pushAt({ gears, friction, pressure, firing }, k, phi, x, x1) {
  const { piston, drag } = gears[k];
  const lever = -piston.area * x1;
  const gas = pressure.length ? lever * valueAt(pressure[k], phi) : 0;
  const { steady, jumping } = appliedAt(gears[k], { phi, x, x1 });
  return {
    torque: gas - x1 * steady,
    gas,
    combustion: firing.length ? lever * valueAt(firing[k], phi) - gas : 0,
    rings: Math.abs(x1) * ((friction?.ring_force ?? 0) + jumping),
    drag: drag * x1 * x1,
  };
}

/** What the masses of cylinder k are at a cycle angle [rad]: its share of inertia and slope, and
 * the torque of its weights; with the piston's position and its derivative. */
export function massesAt({ gears, cylinders, gravity }, k, phi) {
  const { rod, piston, loop } = gears[k];
  const at = loop.at(phi);
  const g = rodCentre(at, rod.center_of_mass);
  let inertia = piston.mass * at.x1 * at.x1 + rod.mass * (g.x1 * g.x1 + g.y1 * g.y1);
  inertia += rod.inertia * at.beta1 * at.beta1;
  let slope = 2 * (piston.mass * at.x1 * at.x2 + rod.mass * (g.x1 * g.x2 + g.y1 * g.y2));
  slope += 2 * rod.inertia * at.beta1 * at.beta2;
  let weight = 0;
  if (gravity !== null) {
    const [ax, ay] = gravityVector(gravity, cylinders[k].bank);
    weight = piston.mass * ax * at.x1 + rod.mass * (ax * g.x1 + ay * g.y1);
  }
  return { x: at.x, x1: at.x1, inertia, slope, weight };
}

/** Torque of gas, weights, friction and loads over the angle [N m] at an angle that is reduced, at
 * a speed; shares of the combustion and phases of the loads : of a motion in a sense. */
export function givenAt({ friction, loads }, of, { shares, phases, sense }, omega) {
  const rings = ringTorque(friction, of, shares);
  const over = torqueOverAngle(loads, phases, of.theta);
  return of.torque + burnt(of.combustion, shares) + over - sense * rings - of.drag * omega;
}

/** Torque of the crank's own weight at a crank angle [N m]. */
export function crankWeight(crank, gravity, theta) {
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
 * angle, at decisions on the fuel and around folds, no cell wider than 6 degrees.
 *
 * cycles : over the cycle angle, of one cylinder after the other, and so on
 * marks : knots [rad], of cycles over the crank angle and decisions
 */
export function edgesOf(shapes, cylinders, cycles, marks, period) {
  const found = [0, period];
  shapes.forEach((shape, k) => found.push(...nearFolds(shape, cylinders[k], period)));
  for (const each of marks) for (const mark of each) found.push(mark);
  cycles.forEach((cycle, k) => {
    const { phase } = cylinders[k % cylinders.length];
    for (const knot of knotsOver(cycle, phase, period)) found.push(knot);
  });
  const edges = distinct(found, SLIVER);
  edges[edges.length - 1] = period;
  const widest = (k) => Math.max(Math.ceil((edges[k + 1] - edges[k]) / WIDEST - 1e-9), 1);
  return split(edges, Array.from({ length: edges.length - 1 }, (_, k) => widest(k)));
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
