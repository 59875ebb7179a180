/** What a motion amounts to over a stretch of angle: mean powers, and peaks between the samples.
 *
 * Integrals are Gauss sums over panels in which everything is smooth; peaks are looked for panel by
 * panel.
 */
import { reactionsAt } from "./reactions.js";

const CANDIDATES = 6;
const GOLDEN = 0.5 * (Math.sqrt(5) - 1);
const CLOSENESS = 45; // steps of the golden section: to 4e-10 of a panel

/** The size of the force in each joint of a cylinder, by its name. */
const JOINTS = {
  "crank pin": (v) => Math.hypot(v.crank_pin_force_x, v.crank_pin_force_y),
  "piston pin": (v) => Math.hypot(v.piston_pin_force_x, v.piston_pin_force_y),
  "side force": (v) => Math.abs(v.side_force),
};

/** The last whole period of a motion that turns from `from` to `to` [rad], the first of those that
 * it holds; without one the last whole revolution, or else all of it. */
export function lastSpan(from, to, ...periods) {
  const turned = Math.abs(to - from);
  const whole = [...periods, 2 * Math.PI].find((each) => turned >= each - 1e-9);
  return { from: whole === undefined ? from : to - Math.sign(to - from) * whole, to };
}

/** The measures of a motion over a span, in SI units; joints as { joint, cylinder, peak,
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
  const joints = places.slice(0, -2).map(({ joint, cylinder }, k) =>
    ({ joint, cylinder, ...peaks[k] }));
  const [fastest, slowest] = peaks.slice(-2).map((each) => each.peak);
  const [outside, rubbed, applied, ...gas] = means.slice(places.length);
  const power = indicated(train, gas);
  const gained = power.indicated_power;
  return {
    mean_speed: speed,
    fluctuation: (fastest + slowest) / Math.abs(speed),
    speed_gain: last.omega - first.omega,
    joints,
    external_torque: outside / speed,
    ...power,
    friction_power: train.friction === null ? null : -rubbed,
    mechanical_efficiency: train.friction === null ? null : efficiency(gained, -rubbed),
    force_power: train.applies ? applied : null,
  };
}

/** The power of the gas, and those of both its ends, from its mean powers on the pistons, and those
 * of the crank ends, [W]. */
function indicated({ pressure, crank_end: ends }, powers) {
  if (!pressure.length) return { indicated_power: null };
  const count = pressure.length;
  const [all, below] = [powers.slice(0, count), powers.slice(count)].map((each) =>
    each.reduce((total, one) => total + one, 0));
  const both = { indicated_power_head_end: all - below, indicated_power_crank_end: below };
  return { indicated_power: all, ...(ends.length ? both : {}) };
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
  const main = { joint: "main bearing", cylinder: null, size: bearing };
  const places = Object.entries(JOINTS).flatMap(([joint, size]) => cylinders.map((_, k) =>
    ({ joint, cylinder: k + 1, size: (v) => size(v.cylinders[k]) })));
  return [main, ...places, { size: (v) => v.crank_speed }, { size: (v) => -v.crank_speed }];
}

/** The sizes of all places, the power from outside, of friction and of the forces on the pistons,
 * and that of the gas and of the crank ends by cylinder, at a sample. */
function rowOf(train, places, sample) {
  const v = reactionsAt(train, sample);
  const gas = v.cylinders.map((each) => each.gas_force * each.piston_velocity);
  const below = train.crank_end.map((_, k) => {
    const { area, crank_end_share: share } = train.gears[k].piston;
    return -share * area * v.cylinders[k].crank_end_pressure * v.cylinders[k].piston_velocity;
  });
  const [rubs, applied] = ["friction_force", "applied_force"].map((name) => v.cylinders.reduce(
    (sum, each) => sum + (each[name] ?? 0) * each.piston_velocity, 0));
  const outside = v.external_torque * v.crank_speed;
  const power = [outside, rubs, applied, ...gas, ...below];
  return [...places.map(({ size }) => size(v)), ...power];
}

/** The span cut into panels in which all is smooth but for the sizes of forces, each with rows at
 * its nodes. */
function panelsOf(motion, rule, { from: first, to: last }, row) {
  const edges = motion.smoothBetween(first, last);
  return edges.slice(1).map((to, k) => {
    const from = edges[k];
    const samples = Array.from(rule.nodes, (node) => motion.at(from + (to - from) * node));
    const spent = samples.map(({ omega }) => (to - from) / omega);
    return { from, to, rows: samples.map(row), spent };
  });
}

/** Integrals over time of everything in the rows. */
function integrals(panels, rule) {
  return panels[0].rows[0].map((_, q) => panels.reduce((total, { rows, spent }) =>
    rows.reduce((sum, row, i) => sum + rule.weights[i] * spent[i] * row[q], total), 0));
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
  const placed = (theta) => [theta, valueAt(theta)];
  let [low, high] = [from, to];
  let [a, b] = [placed(to - GOLDEN * (to - from)), placed(from + GOLDEN * (to - from))];
  for (let n = 0; n < CLOSENESS; n++) {
    if (a[1] > b[1]) {
      [high, b] = [b[0], a];
      a = placed(high - GOLDEN * (high - low));
    } else {
      [low, a] = [a[0], b];
      b = placed(low + GOLDEN * (high - low));
    }
  }
  const ends = [placed(from), placed(to), a, b];
  const [crank_angle, peak] = ends.reduce((best, each) => (each[1] > best[1] ? each : best));
  return { peak, crank_angle };
}
