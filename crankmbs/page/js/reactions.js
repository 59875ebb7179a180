/** Every joint force from crank angle, speed and acceleration, exact (Newton and Euler).
 *
 * Body by body from the piston down, in each cylinder's frame: the piston's X balance gives the rod
 * on the piston along the axis, the rod's moment about the crank pin gives it across, the piston's
 * Y balance the wall, the rod's balance the crank pin, the crank's the main bearing and the torque
 * from outside. Names, signs and frames are those of a result.
 */
import { appliedForce } from "./applied.js";
import { valueAt } from "./cubics.js";
import { frictionForce } from "./friction.js";
import { turnedBy } from "./geometry.js";
import { gravityVector, rodCentre } from "./tables.js";

/** All variables at one sample { time, theta, omega, alpha, external_torque, shares }: numbers, and
 * under `cylinders` an object of numbers for each. */
export function reactionsAt(train, sample) {
  const cylinders = train.cylinders.map((_, k) => cylinderAt(train, sample, k));
  const found = crankAt(train, sample, cylinders);
  let journal = 0;
  for (const { variables } of cylinders) {
    journal += variables.crank_torque;
    variables.journal_torque = journal;
    variables.pin_torque = journal - 0.5 * variables.crank_torque;
  }
  return {
    ...motionAt(sample),
    ...found,
    external_torque: sample.external_torque ?? found.external_torque,
    cylinders: cylinders.map((each) => each.variables),
  };
}

/** Those of the motion and of one cylinder alone, from number 0, without the torques in its crank's
 * journals. */
export function cylinderReactionsAt(train, sample, number) {
  const found = motionAt(sample);
  found.cylinders = [];
  found.cylinders[number] = cylinderAt(train, sample, number).variables;
  return found;
}

function motionAt({ time, theta, omega, alpha }) {
  return { time, crank_angle: theta, crank_speed: omega, crank_acceleration: alpha };
}

/** The variables of one cylinder, and what it adds to the balance of crank and frame. */
function cylinderAt(train, { theta, omega, alpha, shares }, number) {
  const { gears, gravity, cylinders, friction } = train;
  const { rod, piston, shape, loop, top } = gears[number];
  const { phase, bank } = cylinders[number];
  const { radius: r, length: l, offset: e } = shape;
  const area = piston.area ?? 0;
  const [gx, gy] = gravityVector(gravity, bank);
  const phi = theta + phase;
  const at = loop.at(phi);
  const g = rodCentre(at, rod.center_of_mass);
  const square = omega * omega;
  const pressure = pressureAt(train, shares, number, phi);
  const below = train.crank_end.length ? valueAt(train.crank_end[number], phi) : 0;
  const gas = pressure * area;
  const rubs = friction === null ? 0 : frictionForce(friction, shape, at, omega, gas);
  const applied = train.applies ? appliedForce(gears[number], at, omega) : 0;
  const push = gas + rubs + applied;
  const pistonX = at.x2 * square + at.x1 * alpha;
  const rodTurn = at.beta2 * square + at.beta1 * alpha;
  const feltX = g.x2 * square + g.x1 * alpha - gx; // the rod's acceleration minus gravity
  const feltY = g.y2 * square + g.y1 * alpha - gy;
  const felt = pistonX - gx; // the piston's, along the cylinder
  const pinX = piston.mass * felt + push;
  const weight = rod.mass * (at.cosBeta * feltY + at.sinBeta * feltX);
  const moment = (rod.inertia * rodTurn - rod.center_of_mass * weight) / l;
  const pinY = (moment - pinX * at.sinBeta) / at.cosBeta;
  const throwX = rod.mass * feltX + pinX;
  const throwY = rod.mass * feltY + pinY;
  const side = -pinY - piston.mass * gy;
  const inertia = piston.mass * at.x1 ** 2 + rod.mass * (g.x1 ** 2 + g.y1 ** 2);
  const shaking = [-rod.mass * feltX - piston.mass * felt, piston.mass * gy - rod.mass * feltY];
  const variables = {
    rod_angle: at.beta,
    rod_angular_speed: at.beta1 * omega,
    rod_angular_acceleration: rodTurn,
    piston_position: at.x,
    piston_displacement: top - at.x,
    piston_velocity: -at.x1 * omega,
    piston_acceleration: -pistonX,
    gas_pressure: pressure + piston.crank_end_share * below,
    gas_force: gas,
    side_force: side,
    piston_pin_force_x: pinX,
    piston_pin_force_y: pinY,
    crank_pin_force_x: throwX,
    crank_pin_force_y: throwY,
    crank_torque: r * (at.sinPhi * throwX - at.cosPhi * throwY),
  };
  if (train.crank_end.length) variables.crank_end_pressure = below;
  if (train.fuel !== null) variables.fuel = shares[number];
  if (friction !== null) variables.friction_force = rubs;
  if (train.applies) variables.applied_force = applied;
  return {
    variables,
    pull: turnedBy(bank, throwX, throwY),
    shake: turnedBy(bank, ...shaking),
    moment: -at.x * side - e * push,
    kinetic: 0.5 * (inertia + rod.inertia * at.beta1 ** 2) * square,
  };
}

/** What pushes a piston, over its area [Pa], with its share of the combustion. */
export function pressureAt({ pressure, firing }, shares, number, phi) {
  const found = pressure.length ? valueAt(pressure[number], phi) : 0;
  if (!firing.length) return found;
  return found + shares[number] * (valueAt(firing[number], phi) - found);
}

function crankAt({ crank, gravity, levers, throws }, { theta, omega, alpha }, cylinders) {
  const square = omega * omega;
  const first = crank.mass * crank.center_of_mass;
  const [sin, cos] = [Math.sin(theta), Math.cos(theta)];
  const [gx, gy] = gravityVector(gravity, 0);
  const ownX = first * (-cos * square - sin * alpha) - crank.mass * gx;
  const ownY = first * (-sin * square + cos * alpha) - crank.mass * gy;
  const found = {
    external_torque: crank.inertia * alpha - first * (cos * gy - sin * gx),
    main_bearing_force_x: ownX,
    main_bearing_force_y: ownY,
    frame_force_x: -ownX,
    frame_force_y: -ownY,
    frame_moment: 0,
    kinetic_energy: 0.5 * crank.inertia * square,
  };
  for (const { variables, pull, shake, moment, kinetic } of cylinders) {
    found.external_torque -= variables.crank_torque;
    found.main_bearing_force_x += pull[0];
    found.main_bearing_force_y += pull[1];
    found.frame_force_x += shake[0];
    found.frame_force_y += shake[1];
    found.frame_moment += moment;
    found.kinetic_energy += kinetic;
  }
  if (levers === null) return found;
  const about = (part) => levers.reduce((total, lever, k) => total + lever * part(cylinders[k]), 0);
  found.rocking_moment_x = -about((each) => each.shake[1]);
  found.rocking_moment_y = about((each) => each.shake[0]);
  if (throws) { // bearings hold the crank's own mass at its throws
    const { lever, couple: [along, across] } = throws;
    const [x, y] = [cos * along - sin * across, sin * along + cos * across];
    found.rocking_moment_x += lever * ownY - (y * square - x * alpha);
    found.rocking_moment_y += x * square + y * alpha - lever * ownX;
  }
  return found;
}
