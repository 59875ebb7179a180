/** How far to trust a number: step size, order, error, and an error one can state. */
import { remembering } from "./arrays.js";
import { METHODS, stepped } from "./explicit.js";
import { readable } from "./format.js";
import { begun } from "./lesson.js";
import { diagram, overAngle } from "./shapes.js";

const RPM = Math.PI / 30;
const DEGREE = Math.PI / 180;
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
    const y = cycle.angles.map((theta) => between(found, theta, cycle) / RPM);
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

/** The broken line through the steps. */
function between(found, theta, { from, to }) {
  const count = found.length - 1;
  const place = ((theta - from) / (to - from)) * count;
  const k = Math.min(Math.floor(place), count - 1);
  return found[k].omega + (found[k + 1].omega - found[k].omega) * (place - k);
}

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
