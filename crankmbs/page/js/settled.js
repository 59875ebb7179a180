/** What a free run settles to: the motion that repeats itself after a period.
 *
 * Seen once a period the energy E goes through a map. Under loads of c0 + c2 omega^2 every cell is
 * affine, the map is a E + b, and E0 = b / (1 - a). Else Newton's method finds where the map gives
 * back what came, with its derivative multiplied up along the period. With a = 1 and nothing gained
 * every speed is periodic: that with the start's mean is kept.
 */
import { Sum, countUpTo, eliminate } from "./arrays.js";
import { branchAt, firstPhases, isAffine, torqueOverAngle } from "./loads.js";
import { Travel } from "./motion.js";
import { reduceAt } from "./tables.js";

const NONE = 1e-11; // of the energy: nothing but rounding
const SHOTS = 400;
const CLOSE = 1e-3; // of the energy: from so near Newton's method takes over from the run itself
const MOST = 8; // times: how far one step of Newton's method may go
const FARTHEST = 1e6; // of the energy: with no fixed point below it is taken to grow without bound
const SPEEDS = 65; // at which the slope of the loads is looked at

/** The settled motion from a start { angle, speed }, over one period of the grid.
 *
 * warm [J] : an energy to begin with, such as that of a motion close by; null: the start's
 *
 * { ending, travel, theta, factor, balanced } : ending "complete", "slow", "held", "runs_away",
 * "decays" or "wanders"; travel over the period from theta on; factor : what a period leaves of a
 * disturbance; balanced : whether every speed would do
 */
export function settle(train, grid, start, warm) {
  const sense = start.speed < 0 ? -1 : 1;
  const section = new Section(train, grid, start, sense);
  const branch = section.branch(start.speed);
  const bounded = branch && [branch.low, branch.high].some((limit) =>
    sense * limit > 0 && Number.isFinite(limit));
  if (branch && isAffine(branch) && !bounded) return section.inClosedForm(branch, start);
  return section.byNewton(warm ?? section.energyAt(start.speed), start.speed);
}

/** One period of a motion, from an edge of the grid on. */
class Section {
  constructor(train, grid, start, sense) {
    const { edges } = grid;
    const period = edges[edges.length - 1];
    const base = Math.floor(start.angle / period) * period;
    const k = Math.max(countUpTo(edges, start.angle - base) - 1, 0);
    Object.assign(this, { train, grid, sense, period });
    this.theta = base + edges[k];
    this.first = k;
    this.inertia = reduceAt(train, this.theta).inertia;
    this.phases = firstPhases(train.loads, start.speed);
  }

  energyAt(omega) {
    return 0.5 * this.inertia * omega * omega;
  }

  branch(omega) {
    const { train, phases } = this;
    const of = reduceAt(train, this.theta);
    const over = torqueOverAngle(train.loads, phases, this.theta);
    const rest = of.torque + over - 0.5 * of.slope * omega * omega;
    return branchAt(train.loads, phases, 0, omega, rest);
  }

  shot(energy) {
    const begin = { theta: this.theta, time: 0, energy, sense: this.sense };
    const stop = { theta: this.theta + this.sense * this.period, time: Infinity };
    return new Travel(this.train, this.grid, begin, stop);
  }

  found(energy, balanced, ending = "complete") {
    if (ending !== "complete") return { ending, travel: null, theta: this.theta, balanced };
    const travel = this.shot(energy);
    const { theta, period } = this;
    return { ending: travel.ending, travel, theta, period, factor: travel.factor, balanced };
  }

  inClosedForm(branch, start) {
    const map = this.map(branch);
    const energy = this.energyAt(start.speed);
    const gained = map.growth * energy + map.rise;
    if (map.growth < -NONE) {
      const limit = -map.rise / map.growth;
      return this.found(limit, false, limit > 0 ? "complete" : "decays");
    }
    const swing = Math.max(...map.shift.map((shift, i) => map.gain[i] * energy + shift));
    if (Math.abs(gained) > NONE * swing) {
      return this.found(energy, false, gained > 0 ? "runs_away" : "decays");
    }
    const kept = this.withMean(map, start.speed);
    return this.found(kept, true, kept > 0 ? "complete" : "slow");
  }

  /** The affine map over a period: E becomes E + (growth E + rise), at the nodes gain E + shift. */
  map(branch) {
    const { grid, sense } = this;
    const { rule, edges } = grid;
    const s = rule.nodes.length;
    const n = edges.length - 1;
    const cells = Array.from({ length: n }, (_, j) => (this.first + n + sense * j) % n);
    if (sense < 0) cells.forEach((_, j) => (cells[j] = (this.first + 2 * n - 1 - j) % n));
    const one = { gain: [], shift: [], weight: [] };
    let growth = 0;
    let rise = 0;
    const steps = cells.map((number) => {
      const cell = this.affine(number, branch);
      for (let j = 0; j < s; j++) {
        one.gain.push(cell.gain[j] * (1 + growth));
        one.shift.push(cell.gain[j] * rise + cell.shift[j]);
        one.weight.push(cell.weight[j]);
      }
      rise += cell.growth * rise + cell.rise;
      growth += cell.growth + growth * cell.growth;
      return { rise: cell.rise, growth };
    });
    // the cells' rises nearly cancel in a steady motion: each times what the rest makes of it
    const total = new Sum();
    for (const step of steps) total.add(step.rise * ((1 + growth) / (1 + step.growth)));
    return { ...one, growth, rise: total.value };
  }

  /** Of the energy at a cell's begin: gain and shift at its nodes, growth and rise at its end. */
  affine(number, branch) {
    const { train, grid, sense, phases } = this;
    const { rule, edges, tables } = grid;
    const s = rule.nodes.length;
    const width = edges[number + 1] - edges[number];
    const system = new Float64Array(s * s);
    const right = new Float64Array(2 * s);
    const of = { push: [], rate: [], inertia: [] };
    for (let j = 0; j < s; j++) {
      const i = number * s + (sense > 0 ? j : s - 1 - j);
      const inertia = train.crank.inertia + tables.inertia[i];
      const over = torqueOverAngle(train.loads, phases, tables.angles[i]);
      of.inertia.push(inertia);
      of.push.push(tables.torque[i] + over + branch.c0);
      of.rate.push((2 * branch.c2) / inertia);
    }
    for (let j = 0; j < s; j++) {
      right[2 * j] = 1;
      for (let i = 0; i < s; i++) {
        const step = sense * width * rule.matrix[j * s + i];
        right[2 * j + 1] += step * of.push[i];
        system[j * s + i] = (i === j ? 1 : 0) - step * of.rate[i];
      }
    }
    eliminate(system, right, s, 2);
    const cell = { gain: [], shift: [], weight: [], growth: 0, rise: 0 };
    for (let j = 0; j < s; j++) {
      const [gain, shift] = [right[2 * j], right[2 * j + 1]];
      const step = sense * width * rule.weights[j];
      cell.gain.push(gain);
      cell.shift.push(shift);
      cell.weight.push(width * rule.weights[j] * Math.sqrt(0.5 * of.inertia[j]));
      cell.growth += step * of.rate[j] * gain;
      cell.rise += step * (of.push[j] + of.rate[j] * shift);
    }
    return cell;
  }

  /** The energy with which a period lasts as long as at a mean speed [rad/s]. */
  withMean(map, speed) {
    const wanted = this.period / Math.abs(speed);
    const least = Math.max(...map.shift.map((shift, i) => -shift / map.gain[i]));
    let energy = Math.max(this.energyAt(speed), least + 0.5 * this.energyAt(speed));
    for (let n = 0; n < 60; n++) {
      let [time, slope] = [0, 0];
      map.weight.forEach((weight, i) => {
        const kinetic = map.gain[i] * energy + map.shift[i];
        time += weight / Math.sqrt(kinetic);
        slope -= (0.5 * weight * map.gain[i]) / (kinetic * Math.sqrt(kinetic));
      });
      const next = energy - (time - wanted) / slope;
      const inside = next > least ? next : 0.5 * (energy + least);
      if (Math.abs(inside - energy) <= 4e-16 * energy) return inside;
      energy = inside;
    }
    return energy;
  }

  byNewton(begin, speed) {
    const follows = this.mayBeSeveral();
    let energy = begin;
    let [before, close] = [Infinity, !follows];
    for (let n = 0; n < SHOTS; n++) {
      const shot = this.shot(energy);
      if (shot.ending !== "complete") return this.found(energy, false, shot.ending);
      const gained = shot.energy - energy;
      const damping = 1 - shot.factor;
      if (energy > FARTHEST * begin) return this.found(energy, false, "runs_away");
      if (Math.abs(gained) <= NONE * energy && damping <= NONE) {
        return this.found(this.withMeanByShots(energy, speed), true);
      }
      if (follows && Math.abs(gained) <= CLOSE * damping * energy) close = true;
      const step = close ? (damping > NONE ? gained / damping : gained * Infinity) : gained;
      const next = Math.min(Math.max(energy + step, energy / MOST), energy * MOST);
      const moved = Math.abs(next - energy);
      if (moved <= 4e-16 * energy || (moved <= 1e-12 * energy && moved >= 0.5 * before)) {
        return this.found(energy, false);
      }
      [before, energy] = [moved, next];
    }
    return this.found(energy, false, "wanders");
  }

  /** The same where loads bend somewhere: a period lasts about as the inverse root of the energy. */
  withMeanByShots(begin, speed) {
    const wanted = this.period / Math.abs(speed);
    let energy = begin;
    for (let n = 0; n < 60; n++) {
      const longer = this.shot(energy).time / wanted;
      energy *= longer * longer;
      if (Math.abs(longer - 1) <= 2e-15) break;
    }
    return energy;
  }

  /** Whether a load rises with the speed anywhere, so that the map may give back several energies:
   * then the run itself tells to which it goes. */
  mayBeSeveral() {
    return this.train.loads.some(({ over_speed: load }) => load !== null && rises(load));
  }
}

function rises({ knots, pieces }) {
  const far = knots.length ? 2 * Math.max(...knots.map(Math.abs)) + 1 : 1;
  for (let k = 0; k <= SPEEDS; k++) {
    const omega = far * ((2 * k) / SPEEDS - 1);
    const piece = 3 * countUpTo(knots, omega);
    if (pieces[piece + 1] + 2 * pieces[piece + 2] * omega > 0) return true;
  }
  return false;
}
