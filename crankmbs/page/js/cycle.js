/** One cycle of a scene as the page shows it: the settled one, or one that says how it drifts. */
import { countUpTo } from "./arrays.js";
import { RPM, filled } from "./format.js";
import { LECTURES, lecturedAt } from "./lecture.js";
import { lastSpan, measuresOf } from "./measures.js";
import { cylinderReactionsAt, reactionsAt } from "./reactions.js";
import { Refused } from "./refused.js";
import { spread, valueAlong } from "./shapes.js";

const POINTS = 360; // intervals of a curve
const QUICK = { stages: 5, tolerance: null };
const FINE = { stages: 7, tolerance: 1e-11 };

/** The cycle of a scene.
 *
 * fine : with cells cut until they are good, and measures; warm : a cycle close by, or null
 *
 * Raises Refused with the sentence of a motion that ends before its time.
 */
export function cycleOf(engine, scene, endings, { fine = false, warm = null } = {}) {
  const settings = fine ? FINE : QUICK;
  let motion = engine.run(scene, { ...settings, warm: warm?.energy ?? null });
  let why = null;
  if (scene.run.settled && !scene.freed && motion.ending !== "complete") {
    why = motion.ending;
    const run = { ...scene.run, until: scene.period, in_time: false, settled: false };
    motion = engine.run({ ...scene, run }, settings);
  }
  if (motion.ending !== "complete") {
    throw new Refused(filled(endings[motion.ending], { came: scene.crank.inertia }));
  }
  const span = lastSpan(motion.from, motion.to, ...scene.periods);
  const measures = fine ? measuresOf(motion, engine.rules[9], span) : null;
  const angles = spread(span.from, span.to, POINTS);
  const moving = scene.motion === null
    ? engine.samples(motion.train, angles, scene.grid_period)
    : null;
  const rows = angles.map((theta, n) => motion.at(theta, moving?.at(n)));
  return new Cycle(scene, motion, { ...span, angles, rows, why, measures });
}

/** Samples of one cycle, and what the formulas say at them. */
class Cycle {
  constructor(scene, motion, found) {
    Object.assign(this, { scene, motion, ...found });
    const { from, to, rows } = this;
    this.train = motion.train;
    this.sense = Math.sign(to - from);
    this.made = new Map(); // samples, and what lectures say at them
    this.times = rows.map(({ time }) => time);
    this.begin = this.times[0];
    this.duration = this.times[POINTS] - this.begin;
    this.mean = (to - from) / this.duration;
    this.drift = this.rows[POINTS].omega - this.rows[0].omega;
    this.energy = motion.path?.cells[0]?.energy;
    this.leads = leadsOf(this);
  }

  /** What was made under a name before, or is made now. */
  kept(name, make) {
    if (!this.made.has(name)) this.made.set(name, make());
    return this.made.get(name);
  }

  /** All variables at the samples. */
  get samples() {
    return this.samplesOf(null);
  }

  /** Those of the motion and of cylinder k alone, from 0; null: all. every : of so many samples
   * one */
  samplesOf(k, every = 1) {
    const { train, rows, made } = this;
    if (every === 1 && made.has("null, 1")) return made.get("null, 1");
    return this.kept(`${k}, ${every}`, () => rows.filter((_, n) => n % every === 0).map((row) =>
      (k === null ? reactionsAt(train, row) : cylinderReactionsAt(train, row, k))));
  }

  /** The speed at the samples [rad/s]. */
  get speeds() {
    return this.rows.map(({ omega }) => omega);
  }

  get settled() {
    return this.scene.run.settled && this.why === null;
  }

  get prescribed() {
    return this.scene.motion !== null;
  }

  /** The fastest less the slowest speed, of the mean. */
  get fluctuation() {
    if (this.measures) return this.measures.fluctuation;
    const { speeds } = this;
    return (Math.max(...speeds) - Math.min(...speeds)) / Math.abs(this.mean);
  }

  /** What the speed gains in a cycle, in its own sense [rpm]. */
  get gain() {
    return (this.drift * this.sense) / RPM;
  }

  /** What a lecture, by its name, says at the samples at the mean speed; of cylinder k alone, or
   * of all and the main bearing. */
  lectured(name, k = null) {
    const { train, mean, rows } = this;
    return this.kept(`${name}, ${k}`, () => rows.map(({ theta, shares }) =>
      lecturedAt(train, LECTURES[name], { theta, shares, omega: mean, alpha: 0 }, k)));
  }

  /** All variables at any angle of the cycle; whatever is drawn of one pose asks for the same. */
  at(theta) {
    if (theta !== this.asked) {
      this.found = reactionsAt(this.train, this.motion.at(theta));
      this.asked = theta;
    }
    return this.found;
  }

  /** The angle at a time counted from the cycle's begin, which starts again after it. */
  angleAt(time) {
    const { times, begin, duration, angles } = this;
    const within = begin + time - Math.floor(time / duration) * duration;
    const k = Math.min(countUpTo(times, within, 1), POINTS);
    const part = (within - times[k - 1]) / (times[k] - times[k - 1]);
    return angles[k - 1] + (angles[k] - angles[k - 1]) * part;
  }

  /** The angle of the cycle that is whole periods away from another [rad]. */
  within(theta) {
    const [low, period] = [Math.min(this.from, this.to), Math.abs(this.to - this.from)];
    const outside = theta > low + period + 1e-9 || theta < low - 1e-9;
    return outside ? theta - Math.floor((theta - low) / period) * period : theta;
  }

  /** Time from the cycle's begin to an angle. */
  timeTo(theta) {
    return this.motion.at(theta).time - this.begin;
  }

  /** By how much the crank is ahead of a ring that turns evenly [rad], at an angle. */
  leadAt(theta) {
    return valueAlong(this.leads, (theta - this.from) / (this.to - this.from));
  }
}

/** By how much the crank is ahead at the samples [rad], on average over the cycle not at all. */
function leadsOf({ times, angles, from, mean, begin }) {
  const leads = times.map((time, k) => angles[k] - from - mean * (time - begin));
  const middle = leads.slice(1).reduce((sum, each) => sum + each, 0) / (leads.length - 1);
  return leads.map((each) => each - middle);
}
