/** Explicit one-step methods over the crank angle, as one would write them oneself. */
import { branchAt, firstPhases, torqueOf } from "./loads.js";
import { givenAt, reduceAt } from "./tables.js";

/** By name: the order, and a step of dE/dtheta = Q(theta, E) by h. */
export const METHODS = {
  Euler: { order: 1, step: (q, theta, e, h) => e + h * q(theta, e) },
  Heun: {
    order: 2,
    step: (q, theta, e, h) => {
      const first = q(theta, e);
      return e + 0.5 * h * (first + q(theta + h, e + h * first));
    },
  },
  "Runge-Kutta": {
    order: 4,
    step: (q, theta, e, h) => {
      const a = q(theta, e);
      const b = q(theta + 0.5 * h, e + 0.5 * h * a);
      const c = q(theta + 0.5 * h, e + 0.5 * h * b);
      const d = q(theta + h, e + h * c);
      return e + (h / 6) * (a + 2 * b + 2 * c + d);
    },
  },
};

/** The speeds [rad/s] of a settled cycle from its start by a method in so many steps, { theta,
 * omega } after each. */
export function stepped(cycle, name, count) {
  const { train, sense, from, to } = cycle;
  const torque = torqueOn(cycle);
  const h = (to - from) / count;
  const speed = (theta, e) =>
    sense * Math.sqrt(Math.max(2 * e, 0) / reduceAt(train, theta).inertia);
  let energy = cycle.samples[0].kinetic_energy;
  const found = [{ theta: from, omega: speed(from, energy) }];
  for (let k = 0; k < count; k++) {
    energy = METHODS[name].step(torque, from + k * h, energy, h);
    const theta = from + (k + 1) * h;
    found.push({ theta, omega: speed(theta, energy) });
  }
  return found;
}

/** The torque of gas, weights, friction and loads [N m] at a crank angle and a kinetic energy; of a
 * load that jumps at this very speed that above the jump. */
function torqueOn({ train, sense, samples: [first], rows: [{ shares }] }) {
  const phases = firstPhases(train.loads, first.crank_speed);
  return (theta, energy) => {
    const of = reduceAt(train, theta);
    const omega = sense * Math.sqrt(Math.max(2 * energy, 0) / of.inertia);
    const branch = branchAt(train.loads, phases, 0, omega, Infinity);
    return givenAt(train, of, { shares, phases, sense }, omega) + torqueOf(branch, 0, omega);
  };
}
