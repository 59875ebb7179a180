/** What of the crank train depends on the angle alone: reduced inertia and torque.
 *
 *     J = J_crank + sum of  m_p x1^2 + m_r (gx1^2 + gy1^2) + I_r beta1^2
 *
 * over the cylinders, with the rod's centre of mass g = (r cos(phi) + a cos(beta), r sin(phi) - a
 * sin(beta)). Over the cells of a period it is tabulated in layers, each made anew only when what
 * it depends on changes: loops of the geometry, inertia of the masses, torque of gas and weights.
 * The crank's inertia is added where it is used, so that a flywheel costs nothing here.
 */
import { distinct, remembering, wrapped } from "./arrays.js";
import { knotsOver, valueAt, valuesAlong } from "./cubics.js";
import { ringTorque } from "./friction.js";
import { Loop } from "./geometry.js";
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
 * torque of gas and weights [N m], what the combustion of each cylinder adds to it, and what
 * friction depends on: torque of each cylinder's gas, sums of |x1| and of x1^2. */
export function reduceAt(train, theta) {
  const { crank, rod, piston, cylinders, gravity, pressure, combustion, loops } = train;
  const gas = [];
  let rise = 0;
  let square = 0;
  let inertia = crank.inertia;
  let slope = 0;
  let torque = crankWeight(crank, gravity, theta);
  const burning = [];
  for (let k = 0; k < cylinders.length; k++) {
    const phi = theta + cylinders[k].phase;
    const at = loops[k].at(phi);
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
    rise += Math.abs(at.x1);
    square += at.x1 * at.x1;
    if (combustion.length) burning.push(-piston.area * valueAt(combustion[k], phi) * at.x1);
  }
  return { inertia, slope, torque, combustion: burning, gas, rise, square };
}

/** Torque of gas, weights and friction [N m] at an angle that is reduced, with these shares of the
 * combustion, in a sense of rotation at a speed. */
export function givenAt({ friction }, of, shares, sense, omega) {
  const given = of.torque + burnt(of.combustion, shares);
  if (friction === null) return given;
  const rings = ringTorque(friction, of.rise, of.gas, of.combustion, shares);
  return given - sense * rings - friction.viscous * of.square * omega;
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
export function edgesOf(shape, cylinders, cycles, marks, period) {
  const found = [0, period, ...nearFolds(shape, cylinders, period)];
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
function nearFolds(shape, cylinders, period) {
  const { radius, length, offset } = shape;
  const marks = [];
  for (const [fold, gap] of [[0.5, length - radius + offset], [-0.5, length - radius - offset]]) {
    const width = Math.sqrt((2 * Math.max(gap, 0)) / radius);
    if (!(width > 0 && width < WIDEST)) continue;
    const around = [0];
    for (let far = width; far < WIDEST; far *= 2) around.push(-far, far);
    for (const { phase } of cylinders) {
      for (let turn = 0; turn < period - 1; turn += 2 * Math.PI) {
        marks.push(...around.map((each) => wrapped(fold * Math.PI + turn - phase + each, period)));
      }
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
    this.total = remembering(totalOf);
  }

  /** Inertia without the crank's [kg m2], torque [N m] and what combustion adds to it, by cylinder,
   * at the nodes of the cells. */
  of(train, edges, rule) {
    const { shape, crank, rod, piston, cylinders, gravity } = train;
    const masses = [crank.mass * crank.center_of_mass, rod.mass, piston.mass];
    const angles = this.nodes(edges, rule);
    const loops = this.loops(shape, rod.center_of_mass, cylinders, angles);
    const gas = this.gas(loops, cylinders, train.pressure, piston.area, angles);
    const burning = this.burning(loops, cylinders, train.combustion, piston.area, angles);
    const weights = this.weights(loops, masses, cylinders, gravity, angles);
    return {
      angles,
      inertia: this.inertia(loops, piston.mass, rod.mass, rod.inertia),
      torque: this.total([weights, ...gas]),
      combustion: burning,
      gas,
      rise: loops.rise,
      square: loops.squares.piston,
    };
  }
}

/** The sum of arrays. */
function totalOf([first, ...others]) {
  const total = first.slice();
  for (const other of others) for (let i = 0; i < total.length; i++) total[i] += other[i];
  return total;
}

/** Derivatives of every cylinder's loop at crank angles, and the sums of their squares. */
function loopsAt(shape, center, cylinders, angles) {
  const loop = new Loop(shape);
  const empty = () => new Float64Array(angles.length);
  const squares = { piston: empty(), rod: empty(), turn: empty() };
  const rise = empty();
  const each = cylinders.map(({ phase }) => {
    const own = { x1: empty(), gx1: empty(), gy1: empty() };
    for (let i = 0; i < angles.length; i++) {
      const at = loop.at(angles[i] + phase);
      const gx1 = -at.radius * at.sinPhi - center * at.sinBeta * at.beta1;
      const gy1 = at.radius * at.cosPhi - center * at.cosBeta * at.beta1;
      own.x1[i] = at.x1;
      own.gx1[i] = gx1;
      own.gy1[i] = gy1;
      rise[i] += Math.abs(at.x1);
      squares.piston[i] += at.x1 * at.x1;
      squares.rod[i] += gx1 * gx1 + gy1 * gy1;
      squares.turn[i] += at.beta1 * at.beta1;
    }
    return own;
  });
  return { squares, rise, each };
}

function inertiaOf({ squares }, pistonMass, rodMass, rodInertia) {
  const { piston, rod, turn } = squares;
  const inertia = new Float64Array(piston.length);
  for (let i = 0; i < inertia.length; i++) {
    inertia[i] = pistonMass * piston[i] + rodMass * rod[i] + rodInertia * turn[i];
  }
  return inertia;
}

/** Torque of pressures on the crank, by cylinder. */
function gasTorque({ each }, cylinders, pressure, area, angles) {
  return pressure.map((cycle, k) => {
    const torque = valuesAlong(cycle, angles, cylinders[k].phase);
    const { x1 } = each[k];
    for (let i = 0; i < torque.length; i++) torque[i] *= -area * x1[i];
    return torque;
  });
}

/** Torque of the weights on the crank; given the crank's first moment [kg m], rod and piston. */
function weightTorque({ each }, [first, rod, piston], cylinders, gravity, angles) {
  const [gx, gy] = gravityVector(gravity, 0);
  const torque = new Float64Array(angles.length);
  if (gravity === null) return torque;
  for (let i = 0; i < torque.length; i++) {
    torque[i] = first * (gy * Math.cos(angles[i]) - gx * Math.sin(angles[i]));
  }
  cylinders.forEach(({ bank }, k) => {
    const [ax, ay] = gravityVector(gravity, bank);
    const { x1, gx1, gy1 } = each[k];
    for (let i = 0; i < angles.length; i++) {
      torque[i] += piston * ax * x1[i] + rod * (ax * gx1[i] + ay * gy1[i]);
    }
  });
  return torque;
}
