/** What a motion amounts to over a stretch of angle: means, peaks, power, with refined peaks.
 *
 * Integrals are Gauss sums over panels in which everything is smooth, halved where a quantity is
 * not: the size of a force has a kink where the force passes zero. Peaks are looked for between the
 * samples, panel by panel.
 */
import { strokeOf } from "./geometry.js";
import { reactionsAt } from "./reactions.js";

const ROUGH = 1e-7; // of a quantity: such a tail of its polynomial, and the sum errs by its square
const AT_ENDS = 1e-6; // of a quantity: so far off its polynomial at an end it has a kink beside it
const HAIR = 2e-9; // rad: so far inside the end of a panel nothing counts as on a knot
const SHORTEST = 10 * HAIR; // of panels that are halved
const CANDIDATES = 6;
const GOLDEN = 0.5 * (Math.sqrt(5) - 1);
const CLOSENESS = 45; // steps of the golden section: to 4e-10 of a panel

/** The size of the force in each joint of a cylinder, by its name. */
const JOINTS = {
  "crank pin": (v) => Math.hypot(v.crank_pin_force_x, v.crank_pin_force_y),
  "piston pin": (v) => Math.hypot(v.piston_pin_force_x, v.piston_pin_force_y),
  "side force": (v) => Math.abs(v.side_force),
};

/** Over what the motion of a scene that turns from `from` to `to` [rad] is measured: its last
 * period with the loads, or the one that it settles to. */
export function measuredSpan(scene, from, to) {
  const { settled } = scene.run;
  const period = settled ? scene.grid_period : scene.load_period;
  if (period < scene.period + 1e-9) return lastSpan(from, to, scene.period);
  return lastSpan(from, to, period, settled ? "settled period" : "last period");
}

/** The last whole cycle of a motion that ends at `to` after turning from `from`, or the last period
 * of another kind; without one the last whole revolution, or else all of it: its kind, and where it
 * begins [rad]. */
export function lastSpan(from, to, period, cycle = "last cycle") {
  const turned = Math.abs(to - from);
  const sense = Math.sign(to - from);
  for (const [kind, wanted] of [[cycle, period], ["last revolution", 2 * Math.PI]]) {
    if (turned >= wanted - 1e-9) return { kind, from: to - sense * wanted, to };
  }
  return { kind: "whole run", from, to };
}

/** The measures of a motion over a span, in SI units; joints as { joint, cylinder, peak, mean,
 * crank_angle }. rule : of Gauss, with more nodes than the motion's own */
export function measuresOf(motion, rule, span) {
  const { train } = motion;
  const [first, last] = [motion.at(span.from), motion.at(span.to)];
  const duration = last.time - first.time;
  const places = placesOf(train);
  const panels = panelsOf(motion, rule, span, (at) => rowOf(train, places, at));
  const means = integrals(panels, rule).map((each) => each / duration);
  const angle = span.to - span.from;
  const speed = angle / duration;
  const peaks = places.map((place, q) => highest(motion, panels, place, q));
  const joints = places.slice(0, -2).map(({ joint, cylinder }, k) => {
    return { joint, cylinder, ...peaks[k], mean: means[k] };
  });
  const [fastest, slowest] = peaks.slice(-2).map((each) => each.peak);
  const [rods, outside, rubbed, applied, ...gas] = means.slice(places.length);
  const power = indicated(train, span, gas, duration);
  const gained = power.indicated_power;
  return {
    window: span.kind,
    mean_speed: speed,
    fluctuation: (fastest + slowest) / Math.abs(speed),
    speed_gain: last.omega - first.omega,
    joints,
    crank_torque: rods / speed,
    external_torque: outside / speed,
    ...power,
    friction_power: train.friction === null ? null : -rubbed,
    mechanical_efficiency: train.friction === null ? null : efficiency(gained, -rubbed),
    force_power: train.applies ? applied : null,
  };
}

/** Powers and mean effective pressures of the gas, and of both its ends, from its mean powers on
 * the pistons, and those of the crank ends, [W]. */
function indicated(train, { kind, from, to }, powers, duration) {
  const { gears, pressure, crank_end: ends, period } = train;
  if (!pressure.length) return { indicated_power: null, imep: null };
  const [all, below] = [powers.slice(0, pressure.length), powers.slice(pressure.length)];
  const above = all.map((each, k) => each - (below[k] ?? 0));
  const sum = (each) => each.reduce((total, one) => total + one, 0);
  const volumes = gears.map(({ piston, shape }) => piston.area * strokeOf(shape));
  const cycles = Math.round(Math.abs(to - from) / period);
  const whole = ["last cycle", "last period", "settled period"].includes(kind);
  const imepOf = (each, swept) =>
    whole ? each.map((one, k) => (one * duration) / (cycles * swept[k])) : null;
  const found = { indicated_power: sum(all), imep: imepOf(above, volumes) };
  if (!ends.length) return found;
  return {
    ...found,
    imep_crank_end: imepOf(below, volumes.map((one, k) => gears[k].piston.crank_end_share * one)),
    indicated_power_head_end: sum(above),
    indicated_power_crank_end: sum(below),
  };
}

/** Of indicated power I and friction's R: (I - R) / I of an engine, I / (I - R) of a driven one. */
function efficiency(gained, rubbed) {
  if (!gained) return null;
  const left = gained - rubbed;
  return gained > 0 ? left / gained : gained / left;
}

/** What has a peak: every joint's force, the speed and the negative speed. */
function placesOf({ cylinders }) {
  const bearing = (v) => Math.hypot(v.main_bearing_force_x, v.main_bearing_force_y);
  const places = [{ joint: "main bearing", cylinder: null, size: bearing }];
  for (const [joint, size] of Object.entries(JOINTS)) {
    cylinders.forEach((_, k) => {
      places.push({ joint, cylinder: k + 1, size: (v) => size(v.cylinders[k]) });
    });
  }
  return [...places, { size: (v) => v.crank_speed }, { size: (v) => -v.crank_speed }];
}

/** The sizes of all places, the power of the rods, from outside, of friction and of the forces on
 * the pistons, and that of the gas and of the crank ends by cylinder, at a sample. */
function rowOf(train, places, sample) {
  const v = reactionsAt(train, sample);
  const rods = v.cylinders.reduce((sum, each) => sum + each.crank_torque, 0);
  const gas = v.cylinders.map((each) => each.gas_force * each.piston_velocity);
  const below = train.crank_end.map((_, k) => {
    const { area, crank_end_share: share } = train.gears[k].piston;
    return -share * area * v.cylinders[k].crank_end_pressure * v.cylinders[k].piston_velocity;
  });
  const [rubs, applied] = ["friction_force", "applied_force"].map((name) => v.cylinders.reduce(
    (sum, each) => sum + (each[name] ?? 0) * each.piston_velocity, 0));
  const outside = v.external_torque * v.crank_speed;
  const power = [rods * v.crank_speed, outside, rubs, applied, ...gas, ...below];
  return [...places.map(({ size }) => size(v)), ...power];
}

/** The span cut into panels, each with rows at its nodes, halved where one is not smooth. */
function panelsOf(motion, rule, span, row) {
  const edges = motion.smoothBetween(span.from, span.to);
  const open = [];
  for (let k = edges.length - 1; k > 0; k--) open.push([edges[k - 1], edges[k]]);
  const done = [];
  const scale = [];
  while (open.length) {
    const [from, to] = open.pop();
    const samples = Array.from(rule.nodes, (node) => motion.at(from + (to - from) * node));
    const rows = samples.map(row);
    rows.forEach((each) => each.forEach((value, q) => {
      scale[q] = Math.max(scale[q] ?? 0, Math.abs(value));
    }));
    const hair = HAIR * Math.sign(to - from);
    const ends = [from + hair, to - hair].map((theta) => row(motion.at(theta)));
    const legendre = legendreAt(1.0 - 2.0 * HAIR / Math.abs(to - from), rule.nodes.length);
    if (Math.abs(to - from) > SHORTEST && isRough(rows, ends, rule, scale, legendre)) {
      const middle = 0.5 * (from + to);
      open.push([middle, to], [from, middle]);
    } else {
      const spent = samples.map(({ omega }) => (to - from) / omega);
      done.push({ from, to, rows, spent });
    }
  }
  return done;
}

/** Legendre's polynomials below a degree, at a place from -1 to 1. */
function legendreAt(z, count) {
  const values = [1.0, z];
  for (let j = 1; j + 1 < count; j++) {
    values.push(((2 * j + 1) * z * values[j] - j * values[j - 1]) / (j + 1));
  }
  return values;
}

/** Whether the polynomial through the nodes still has much in its last two coefficients, or is off
 * beside an end, where no node sees a kink; legendre : Legendre's polynomials at the later of these
 * places. */
function isRough(rows, [first, last], rule, scale, legendre) {
  const s = rule.nodes.length;
  return scale.some((size, q) => {
    let [tail, atFirst, atLast] = [0, 0, 0];
    for (let j = 0; j < s; j++) {
      let sum = 0;
      for (let i = 0; i < s; i++) sum += rule.to_legendre[j * s + i] * rows[i][q];
      atFirst += (j % 2 ? -sum : sum) * legendre[j];
      atLast += sum * legendre[j];
      if (j >= s - 2) tail += Math.abs(sum);
    }
    const off = Math.abs(atFirst - first[q]) + Math.abs(atLast - last[q]);
    return tail > ROUGH * size || off > AT_ENDS * size;
  });
}

/** Integrals over time of everything in the rows. */
function integrals(panels, rule) {
  const totals = panels[0].rows[0].map(() => 0);
  for (const { rows, spent } of panels) {
    rows.forEach((row, i) => row.forEach((value, q) => {
      totals[q] += rule.weights[i] * spent[i] * value;
    }));
  }
  return totals;
}

/** The largest value of a place, number q in the rows, and the crank angle where it is. */
function highest(motion, panels, { size }, q) {
  const valueAt = (theta) => size(reactionsAt(motion.train, motion.at(theta)));
  const coarse = panels.map(({ from, to, rows }) => {
    const values = rows.map((row) => row[q]);
    const top = Math.max(...values);
    return { from, to, top, reach: top + (top - Math.min(...values)) };
  });
  const most = Math.max(...coarse.map((each) => each.top));
  const order = coarse.filter((each) => each.reach >= most).sort((a, b) => b.top - a.top);
  const found = order.slice(0, CANDIDATES).map((panel) => highestIn(valueAt, panel));
  return found.reduce((best, each) => (each.peak > best.peak ? each : best));
}

/** The same in a panel in which it rises and falls at most once, by the golden section. */
function highestIn(valueAt, { from, to }) {
  let [low, high] = [from, to];
  let [a, b] = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
  let [atA, atB] = [valueAt(a), valueAt(b)];
  for (let n = 0; n < CLOSENESS; n++) {
    if (atA > atB) {
      [high, b, atB] = [b, a, atA];
      a = high - GOLDEN * (high - low);
      atA = valueAt(a);
    } else {
      [low, a, atA] = [a, b, atB];
      b = low + GOLDEN * (high - low);
      atB = valueAt(b);
    }
  }
  const ends = [[from, valueAt(from)], [to, valueAt(to)], [a, atA], [b, atB]];
  const [crank_angle, peak] = ends.reduce((best, each) => (each[1] > best[1] ? each : best));
  return { peak, crank_angle };
}
