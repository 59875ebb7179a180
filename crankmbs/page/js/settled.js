/** What a free run settles to: the motion that repeats itself after a period.
 *
 * Seen once a period the energy E goes through a map. Under loads of c0 + c2 omega^2 every cell is
 * affine, the map is a E + b, and E0 = b / (1 - a). Else Newton's method finds where the map gives
 * back what came, with its derivative multiplied up along the period. With a = 1 and nothing gained
 * every speed is periodic: that with the start's mean is kept.
 */
import { AffinePeriod, areAffine } from "./affine.js";
import { countUpTo } from "./arrays.js";
import { SLOW } from "./cell.js";
import { branchAt, firstPhases } from "./loads.js";
import { Travel } from "./motion.js";
import { reduceAt, unloadedAt } from "./tables.js";

const NONE = 1e-11; // of the energy: nothing but rounding
const SHOTS = 400;
const CLOSE = 1e-3; // of the energy: from so near Newton's method takes over from the run itself
const MOST = 8; // times: how far one step of Newton's method may go
const FARTHEST = 1e6; // of the energy: with no fixed point below it is taken to grow without bound

/** The settled motion from a start { angle, speed }, over one period of the grid.
 *
 * warm [J] : an energy to begin with, such as that of a motion close by; null: the start's
 *
 * { train, ending, motion, theta, period, sense, factor, balanced } : ending "complete", "slow",
 * "held", "runs_away", "decays" or "wanders"; motion : { path, time } of the period from theta on;
 * factor : what a period leaves of a disturbance; balanced : whether every speed would do
 */
export function settle(train, grid, start, warm) {
  const sense = start.speed < 0 ? -1 : 1;
  const section = new Section(train, grid, start, sense);
  const branch = section.affineBranch(start.speed);
  if (branch !== null) return section.inClosedForm(branch, start);
  return section.byNewton(warm ?? section.energyAt(start.speed), start.speed);
}

/** One period of a motion, from an edge of the grid on. */
export class Section {
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
    const { train, phases, sense } = this;
    const of = reduceAt(train, this.theta);
    const rest = unloadedAt(train, of, { shares: [], phases, sense }, omega);
    return branchAt(train.loads, phases, 0, omega, rest);
  }

  /** The branch at a speed if under it every cell is affine, at whatever speed; else null. */
  affineBranch(omega) {
    const branch = this.branch(omega);
    return branch !== null && areAffine(this.train, branch, this.sense) ? branch : null;
  }

  shot(energy) {
    const begin = { theta: this.theta, time: 0, energy, sense: this.sense };
    const stop = { theta: this.theta + this.sense * this.period, time: Infinity };
    return new Travel(this.train, this.grid, begin, stop);
  }

  /** What is found: the motion over a period, or none where it ends otherwise. */
  found(ending, motion = null, about = {}) {
    const { train, theta, period, sense } = this;
    const unknown = { factor: undefined, balanced: false };
    return { train, ending, motion, theta, period, sense, ...unknown, ...about };
  }

  inClosedForm(branch, start) {
    const period = new AffinePeriod(this, branch);
    const { growth, rise } = period.whole;
    const energy = this.energyAt(start.speed);
    const gained = growth * energy + rise;
    const balanced = growth >= -NONE;
    if (balanced && Math.abs(gained) > NONE * period.sweep(energy).most) {
      return this.found(gained > 0 ? "runs_away" : "decays");
    }
    if (!balanced && !(rise > 0)) return this.found("decays");
    const motion = balanced ? this.withMean(period, start.speed) : period.sweep(-rise / growth);
    const slow = !(motion.least > SLOW * period.largest());
    return this.found(slow ? "slow" : "complete", motion, { factor: 1 + growth, balanced });
  }

  /** The motion of which a period lasts as long as at a mean speed [rad/s], by Newton's method: the
   * duration falls convexly, from without bound where the least energy is nothing. */
  withMean(period, speed) {
    const wanted = this.period / Math.abs(speed);
    let energy = this.energyAt(speed);
    let motion = period.sweep(energy);
    const floor = energy - motion.least;
    if (motion.least <= 0) {
      energy += floor;
      motion = period.sweep(energy);
    }
    for (let n = 0; n < 60; n++) {
      const step = (motion.time - wanted) / motion.slope;
      if (!(Math.abs(step) > 4e-16 * energy)) break;
      energy = Math.max(energy - step, 0.5 * (energy + floor));
      motion = period.sweep(energy);
    }
    return motion;
  }

  byNewton(begin, speed) {
    // where a load rises with the speed there may be several: the run itself tells to which it goes
    const several = this.train.loads.some(({ over_speed: load }) => load !== null && rises(load));
    let energy = begin;
    let before = { gained: Infinity, moved: Infinity };
    const bracket = { low: 0, high: Infinity };
    for (let n = 0; n < SHOTS; n++) {
      const shot = this.shot(energy);
      if (shot.ending !== "complete") return this.found(shot.ending);
      const gained = shot.energy - energy;
      const damping = 1 - shot.factor;
      if (energy > FARTHEST * begin) return this.found("runs_away");
      if (Math.abs(gained) <= NONE * Math.min(energy, begin) && damping <= NONE) {
        return this.shown(this.withMeanByShots(energy, speed), true);
      }
      bracket[gained > 0 ? "low" : "high"] = energy;
      const follows = several && Math.abs(gained) > CLOSE * damping * energy;
      const next = follows ? shot.energy : nextIn(bracket, energy, gained, damping, before.gained);
      const moved = Math.abs(next - energy);
      if (moved <= 4e-16 * energy || (moved <= 1e-12 * energy && moved >= 0.5 * before.moved)) {
        return this.shown(energy, false);
      }
      before = { gained, moved };
      energy = next;
    }
    return this.found("wanders");
  }

  /** The period that begins with an energy [J], solved cell by cell. */
  shown(energy, balanced) {
    const shot = this.shot(energy);
    return this.found(shot.ending, shot, { factor: shot.factor, balanced });
  }

  /** The same where loads bend: a period lasts about as the inverse root of the energy. */
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
}

/** The energy to try next: Newton's step, no farther than MOST times; the middle of the bracket
 * where that leaves it, or where kinks let the steps gain little. */
function nextIn({ low, high }, energy, gained, damping, before) {
  const step = damping > NONE ? gained / damping : gained * Infinity;
  const next = Math.min(Math.max(energy + step, energy / MOST), energy * MOST);
  const slow = Math.abs(gained) > 0.5 * Math.abs(before) && Math.abs(step) > 1e-9 * energy;
  const closed = low > 0 && high < Infinity;
  const inside = next >= low && next <= high && !(closed && slow);
  return inside || !closed ? next : 0.5 * (low + high);
}

/** Whether a load rises with the speed anywhere. */
function rises({ knots, pieces }) {
  const far = knots.length ? 2 * Math.max(...knots.map(Math.abs)) + 1 : 1;
  const ends = [-far, ...knots, far];
  const slope = (k, omega) => pieces[3 * k + 1] + 2 * pieces[3 * k + 2] * omega;
  return ends.slice(1).some((end, k) => Math.max(slope(k, ends[k]), slope(k, end)) > 0);
}
