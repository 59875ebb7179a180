/** How far to trust a number: step size, order, error, and an error one can state. */
import { remembering } from "./arrays.js";
import { DEGREE, RPM, readable } from "./format.js";
import { begun } from "./lesson.js";
import { branchAt, firstPhases, torqueOf } from "./loads.js";
import { diagram, overAngle, valueAlong } from "./shapes.js";
import { givenAt, reduceAt } from "./tables.js";

const COUNTS = [36, 48, 72, 108, 144, 216, 288, 432, 576, 864, 1152, 1728, 2304];
const STYLES = { Euler: "exact", Heun: "second", "Runge-Kutta": "third" };

export function start() {
  return begun({ step: STEP, order: ORDER, stated: STATED });
}

/** How many steps of a size [deg] a cycle takes, an even number. */
function countOf({ from, to }, size) {
  return 2 * Math.max(Math.round(Math.abs(to - from) / (2 * size * DEGREE)), 2);
}

/** By how much a method is off, where it is worst in a settled cycle, of the mean speed. */
function errorOf(cycle, method, count) {
  return largest(stepped(cycle, method, count), ({ theta }) => cycle.motion.at(theta).omega, cycle);
}

/** The largest difference of speeds in steps from others at the same angles, of the mean. */
function largest(found, other, { mean }) {
  const far = (most, each, k) => Math.max(most, Math.abs(each.omega - other(each, k)));
  return found.reduce(far, 0) / Math.abs(mean);
}

function digitsOf(error) {
  return -Math.log10(Math.max(error, 1e-16));
}

const STEP = {
  shapes: (cycle, { size, method }) => {
    const found = stepped(cycle, method, countOf(cycle, size));
    const speeds = found.map(({ omega }) => omega / RPM);
    const part = (theta) => (theta - cycle.from) / (cycle.to - cycle.from);
    const y = cycle.angles.map((theta) => valueAlong(speeds, part(theta))); // a broken line
    const curves = [
      { name: "exact", of: (v) => v.crank_speed / RPM },
      { name: "in steps", style: "exact", y },
    ];
    const apart = [["in steps − exact", 1, 0]];
    return [overAngle(cycle, { title: "crank speed", unit: "rpm", curves, apart })];
  },
  says: (cycle, { size, method }) => {
    const count = countOf(cycle, size);
    const off = (errorOf(cycle, method, count) * Math.abs(cycle.mean)) / RPM;
    return { count: String(count), off: `${readable(off, off < 1 ? 4 : 1)} rpm` };
  },
};

/** The work-precision diagram: digits over steps, each method a line as steep as its order. */
const ORDER = {
  shapes: (cycle, { size, method }) => {
    const count = countOf(cycle, size);
    const error = errorOf(cycle, method, count);
    return [digitsOver("correct digits over steps", linesOf(cycle), count, error)];
  },
  says: (cycle, { size, method }) => {
    const count = countOf(cycle, size);
    const [error, half] = [count, 2 * count].map((n) => errorOf(cycle, method, n));
    return { digits: readable(digitsOf(error), 1), times: readable(error / half, 1) };
  },
};

/** All methods at all numbers of steps, once for each cycle. */
const linesOf = remembering((cycle) => Object.entries(METHODS).map(([name, { order }]) => ({
  name: `${name}, order ${order}`,
  style: STYLES[name],
  errors: COUNTS.map((count) => errorOf(cycle, name, count)),
})));

/** The error that two runs state, beside the true one. */
const STATED = {
  shapes: (cycle, { size, method }) => {
    const count = countOf(cycle, size);
    const [truth] = pair(cycle, method, count);
    return [digitsOver("error stated and true", bothOf(cycle, method), count, truth)];
  },
  says: (cycle, { size, method }) => {
    const [truth, said] = pair(cycle, method, countOf(cycle, size));
    return { ratio: readable(said / truth, 2) };
  },
};

const bothOf = remembering((cycle, method) => {
  const both = COUNTS.map((count) => pair(cycle, method, count));
  return [
    { name: "true", errors: both.map(([truth]) => truth) },
    { name: "stated", style: "exact", errors: both.map(([, said]) => said) },
  ];
});

/** The true error with so many steps, and what that run with one of half as many states. */
function pair(cycle, method, count) {
  const coarse = stepped(cycle, method, count / 2);
  const fine = stepped(cycle, method, count).filter((_, k) => k % 2 === 0);
  const truth = largest(fine, ({ theta }) => cycle.motion.at(theta).omega, cycle);
  const apart = largest(fine, (_, k) => coarse[k].omega, cycle);
  return [truth, apart / (2 ** METHODS[method].order - 1)];
}

/** Lines { name, style, errors } over the numbers of steps; count, error : of the dot */
function digitsOver(title, lines, count, error) {
  return diagram({
    title,
    right: { text: "steps in a cycle, power of ten", unit: "" },
    up: { text: "correct digits", unit: "" },
    curves: lines.map(({ name, style, errors }) =>
      ({ name, style, x: COUNTS.map(Math.log10), y: errors.map(digitsOf) })),
    of: () => [Math.log10(count), digitsOf(error)],
    holds: { y: [0] },
  });
}

/** By name: the order, and a step of dE/dtheta = Q(theta, E) by h. */
const METHODS = {
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
function stepped(cycle, name, count) {
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
