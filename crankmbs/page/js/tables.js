/** What of the crank train depends on the angle alone: reduced inertia and torque.
 *
 *     J = J_crank + sum of  m_p x1^2 + m_r (gx1^2 + gy1^2) + I_r beta1^2
 *
 * over the cylinders, with the rod's centre of mass g = (r cos(phi) + a cos(beta), r sin(phi) - a
 * sin(beta)). Over the cells of a period it is tabulated in layers, each made anew only when what
 * it depends on changes: loops of the geometry, inertia of the masses, torque of gas and weights.
 * The crank's inertia is added where it is used, so that a flywheel costs nothing here.
 */
import { appliedAt, appliedAlong } from "./applied.js";
import { distinct, remembering, wrapped } from "./arrays.js";
import { knotsOver, valueAt, valuesAlong } from "./cubics.js";
import { ringTorque } from "./friction.js";
import { Loop, topPosition } from "./geometry.js";
import { nodesBetween } from "./rule.js";

const WIDEST = (6 * Math.PI) / 180;
const SLIVER = 1e-12; // rad: two edges closer than this are one

/** Gravity [m/s2] in the frame of a cylinder at this bank [rad]. */
export function gravityVector(gravity, bank) {
  if (gravity === null) return [0, 0];
  const angle = gravity.angle - bank;
  return [gravity.acceleration * Math.cos(angle), gravity.acceleration * Math.sin(angle)];
}

/** The crank train at one crank angle [rad]: inertia J [kg m2] with the crank's, slope dJ/dtheta,
 * torque of gas, weights and forces on the pistons [N m], what the combustion of each cylinder adds
 * to it, and of friction the torque of each cylinder's gas, what rings oppose to either sense of
 * rotation without it [N m], and drag, torque per speed [N m s/rad]. */
export function reduceAt(train, theta) {
  const { crank, gears, cylinders, gravity, pressure, combustion } = train;
  const force = train.friction?.ring_force ?? 0;
  const gas = [];
  let rings = 0;
  let drag = 0;
  let inertia = crank.inertia;
  let slope = 0;
  let torque = crankWeight(crank, gravity, theta);
  const burning = [];
  for (let k = 0; k < cylinders.length; k++) {
    const { rod, piston, loop } = gears[k];
    const phi = theta + cylinders[k].phase;
    const at = loop.at(phi);
    const g = rodCentre(at, rod.center_of_mass);
    inertia += piston.mass * at.x1 * at.x1 + rod.mass * (g.x1 * g.x1 + g.y1 * g.y1);
    inertia += rod.inertia * at.beta1 * at.beta1;
    slope += 2 * (piston.mass * at.x1 * at.x2 + rod.mass * (g.x1 * g.x2 + g.y1 * g.y2));
    slope += 2 * rod.inertia * at.beta1 * at.beta2;
    if (gravity !== null) {
      const [ax, ay] = gravityVector(gravity, cylinders[k].bank);
      torque += piston.mass * ax * at.x1 + rod.mass * (ax * g.x1 + ay * g.y1);
    }
    if (pressure.length) gas.push(-piston.area * valueAt(pressure[k], phi) * at.x1);
    torque += gas[k] ?? 0;
    const { steady, jumping } = appliedAt(gears[k], at);
    torque -= at.x1 * steady;
    rings += Math.abs(at.x1) * (force + jumping);
    drag += gears[k].drag * at.x1 * at.x1;
    if (combustion.length) burning.push(-piston.area * valueAt(combustion[k], phi) * at.x1);
  }
  return { inertia, slope, torque, combustion: burning, gas, rings, drag };
}

/** Torque of gas, weights and friction [N m] at an angle that is reduced, with these shares of the
 * combustion, in a sense of rotation at a speed. */
export function givenAt({ friction }, of, shares, sense, omega) {
  const rings = ringTorque(friction, of.rings, of.gas, of.combustion, shares);
  return of.torque + burnt(of.combustion, shares) - sense * rings - of.drag * omega;
}

/** Torque of the crank's own weight at a crank angle [N m]. */
function crankWeight(crank, gravity, theta) {
  const [gx, gy] = gravityVector(gravity, 0);
  const first = crank.mass * crank.center_of_mass;
  return first * (gy * Math.cos(theta) - gx * Math.sin(theta));
}

/** What the combustion adds with these shares [N m]. */
function burnt(combustion, shares) {
  return combustion.reduce((sum, each, k) => sum + shares[k] * each, 0);
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
    for (let turn = 0; turn < period - 1; turn += 2 * Math.PI) {
      marks.push(...around.map((each) => wrapped(fold * Math.PI + turn - phase + each, period)));
    }
  }
  return marks;
}

/** A maker of tables, which remembers every layer of its last ones. */
export class Tables {
  constructor() {
    this.nodes = remembering(nodesBetween);
    this.loops = remembering(loopsAt);
    this.inertia = remembering(inertiaOf);
    this.gas = remembering(gasTorque);
    this.burning = remembering(gasTorque);
    this.weights = remembering(weightTorque);
    this.applied = remembering(appliedTorque);
    this.rings = remembering(ringsOf);
    this.drag = remembering(dragOf);
    this.total = remembering(totalOf);
  }

  /** Inertia without the crank's [kg m2], torque [N m] and what combustion adds to it, by cylinder,
   * at the nodes of the cells. */
  of(train, edges, rule) {
    const { crank, gears, cylinders, gravity, friction } = train;
    const first = crank.mass * crank.center_of_mass;
    const angles = this.nodes(edges, rule);
    const shapes = gears.map(({ shape, rod }) => [shape, rod.center_of_mass]);
    const masses = gears.map(({ rod, piston }) => [piston.mass, rod.mass, rod.inertia]);
    const areas = gears.map(({ piston }) => piston.area);
    const loops = this.loops(shapes, cylinders, angles);
    const gas = this.gas(loops, cylinders, train.pressure, areas, angles);
    const weights = this.weights(loops, masses, first, cylinders, gravity, angles);
    const laws = gears.map(({ applied }) => applied);
    const { steady, jumping } = this.applied(loops, laws, cylinders, angles);
    return {
      angles,
      inertia: this.inertia(loops, masses),
      torque: this.total([weights, ...gas, ...steady]),
      combustion: this.burning(loops, cylinders, train.combustion, areas, angles),
      gas,
      rings: this.rings(loops, friction?.ring_force ?? 0, jumping),
      drag: this.drag(loops, gears.map((gear) => gear.drag)),
    };
  }
}

/** The sum of arrays. */
function totalOf([first, ...others]) {
  const total = first.slice();
  for (const other of others) for (let i = 0; i < total.length; i++) total[i] += other[i];
  return total;
}

/** Positions of every cylinder's piston and derivatives of its loop at crank angles.
 *
 * shapes : [shape, centre of mass of the rod from the crank pin] of each
 */
function loopsAt(shapes, cylinders, angles) {
  const empty = () => new Float64Array(angles.length);
  return shapes.map(([shape, center], k) => {
    const loop = new Loop(shape);
    const top = topPosition(shape);
    const { phase } = cylinders[k];
    const own = { s: empty(), x1: empty(), gx1: empty(), gy1: empty(), beta1: empty() };
    for (let i = 0; i < angles.length; i++) {
      const at = loop.at(angles[i] + phase);
      const gx1 = -at.radius * at.sinPhi - center * at.sinBeta * at.beta1;
      const gy1 = at.radius * at.cosPhi - center * at.cosBeta * at.beta1;
      own.s[i] = top - at.x;
      own.x1[i] = at.x1;
      own.gx1[i] = gx1;
      own.gy1[i] = gy1;
      own.beta1[i] = at.beta1;
    }
    return own;
  });
}

/** masses : [piston's, rod's, its moment of inertia] of each cylinder */
function inertiaOf(loops, masses) {
  return summed(loops, ({ x1, gx1, gy1, beta1 }, k) => {
    const [piston, rod, turn] = masses[k];
    return (i) => piston * x1[i] * x1[i] + rod * (gx1[i] * gx1[i] + gy1[i] * gy1[i]) +
      turn * beta1[i] * beta1[i];
  });
}

/** What all cylinders sum up to, given for each by the number of the node. */
function summed(loops, of) {
  const sum = new Float64Array(loops[0].x1.length);
  loops.forEach((loop, k) => {
    const value = of(loop, k);
    for (let i = 0; i < sum.length; i++) sum[i] += value(i);
  });
  return sum;
}

/** Torque per speed of what drags at each piston [N m s/rad]. */
function dragOf(loops, drags) {
  return summed(loops, ({ x1 }, k) => (i) => drags[k] * x1[i] * x1[i]);
}

/** What opposes either sense of rotation [N m]: the rings, and what jumps where a piston turns. */
function ringsOf(loops, force, jumping) {
  return summed(loops, ({ x1 }, k) => (i) =>
    Math.abs(x1[i]) * (force + (jumping[k] ? jumping[k][i] : 0)));
}

/** Torque of the forces from outside on each piston, and half of what they are more on the way back
 * [N]; null for a piston on which none acts. */
function appliedTorque(loops, laws, cylinders, angles) {
  const each = loops.map((loop, k) => appliedAlong(laws[k], loop, angles, cylinders[k].phase));
  const jumping = each.map((one) => one && one.jumping);
  const acting = each.map((one, k) => one && one.steady.map((force, i) => -force * loops[k].x1[i]));
  return { steady: acting.filter((one) => one !== null), jumping };
}

/** Torque of pressures on the crank, by cylinder. */
function gasTorque(loops, cylinders, pressure, areas, angles) {
  return pressure.map((cycle, k) => {
    const torque = valuesAlong(cycle, angles, cylinders[k].phase);
    const { x1 } = loops[k];
    for (let i = 0; i < torque.length; i++) torque[i] *= -areas[k] * x1[i];
    return torque;
  });
}

/** Torque of the weights on the crank, of which first is the first moment [kg m]. */
function weightTorque(loops, masses, first, cylinders, gravity, angles) {
  const [gx, gy] = gravityVector(gravity, 0);
  const torque = new Float64Array(angles.length);
  if (gravity === null) return torque;
  for (let i = 0; i < torque.length; i++) {
    torque[i] = first * (gy * Math.cos(angles[i]) - gx * Math.sin(angles[i]));
  }
  cylinders.forEach(({ bank }, k) => {
    const [ax, ay] = gravityVector(gravity, bank);
    const { x1, gx1, gy1 } = loops[k];
    const [piston, rod] = masses[k];
    for (let i = 0; i < angles.length; i++) {
      torque[i] += piston * ax * x1[i] + rod * (ax * gx1[i] + ay * gy1[i]);
    }
  });
  return torque;
}
