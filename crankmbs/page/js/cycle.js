/** One cycle of a scene as the page shows it: the settled one, or one that says how it drifts. */
import { filled } from "./format.js";
import { LECTURES, cylinderLectured, lecturedAt } from "./lecture.js";
import { measuredSpan, measuresOf } from "./measures.js";
import { reactionsAt } from "./reactions.js";
import { Refused } from "./refused.js";

const POINTS = 360; // intervals of a curve
const QUICK = { stages: 5, tolerance: null };
const FINE = { stages: 7, tolerance: 1e-11 };
const RPM = Math.PI / 30;

/** The cycle of a scene.
 *
 * fine : with cells cut until they are good, and measures; warm : a cycle close by, or null;
 * speed : the mean [rad/s] to which the loads are rebalanced, or null
 *
 * Raises Refused with the sentence of a motion that ends before its time.
 */
export function cycleOf(engine, asked, endings, { fine = false, warm = null, speed = null } = {}) {
  const settings = fine ? FINE : QUICK;
  const { scene, share } = balanced(engine, asked, endings, { speed, settings });
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
  const span = measuredSpan(scene, motion.from, motion.to);
  const measures = fine ? measuresOf(motion, engine.rules[9], span) : null;
  return new Cycle(scene, motion, span, { why, measures, share });
}

/** A scene with its loads so that it settles to a mean speed, and by what share they are scaled. */
function balanced(engine, scene, endings, { speed, settings }) {
  if (speed === null || !scene.run.settled) return { scene, share: 1 };
  const found = engine.rebalanced(scene, speed, settings);
  if (found.ending !== "complete") throw new Refused(endings[found.ending]);
  return found;
}

/** Samples of one cycle, and what the formulas say at them. */
class Cycle {
  constructor(scene, motion, span, { why, measures, share }) {
    const { from, to, kind } = span;
    Object.assign(this, { scene, motion, from, to, why, measures, share, window: kind });
    this.train = motion.train;
    this.sense = Math.sign(to - from);
    this.angles = Array.from({ length: POINTS + 1 }, (_, k) => from + ((to - from) * k) / POINTS);
    this.rows = this.angles.map((theta) => motion.at(theta));
    this.samples = this.rows.map((row) => reactionsAt(this.train, row));
    const last = this.samples[POINTS];
    this.begin = this.samples[0].time;
    this.duration = last.time - this.begin;
    this.mean = (to - from) / this.duration;
    this.drift = last.crank_speed - this.samples[0].crank_speed;
    this.energy = motion.path?.cells[0]?.energy;
    this.answers = new Map();
    this.leads = leadsOf(this);
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
    const speeds = this.samples.map((v) => v.crank_speed);
    return (Math.max(...speeds) - Math.min(...speeds)) / Math.abs(this.mean);
  }

  /** What the speed gains in a cycle, in its own sense [rpm]. */
  get gain() {
    return (this.drift * this.sense) / RPM;
  }

  /** What a lecture, by its name, says at the samples at the mean speed; of cylinder k alone, or
   * of all and the main bearing. */
  lectured(name, k = null) {
    const key = `${name}, ${k}`;
    if (!this.answers.has(key)) {
      const { train, mean } = this;
      const lecture = LECTURES[name];
      const say = (sample) => {
        if (k === null) return lecturedAt(train, lecture, sample);
        const cylinders = [];
        cylinders[k] = cylinderLectured(train, lecture, sample, k);
        return { cylinders };
      };
      const at = ({ theta, shares }) => say({ theta, shares, omega: mean, alpha: 0 });
      this.answers.set(key, this.rows.map(at));
    }
    return this.answers.get(key);
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
    const { samples, begin, duration, angles } = this;
    const within = begin + time - Math.floor(time / duration) * duration;
    let [low, high] = [0, POINTS];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (samples[middle].time <= within) low = middle;
      else high = middle;
    }
    const part = (within - samples[low].time) / (samples[high].time - samples[low].time);
    return angles[low] + (angles[high] - angles[low]) * part;
  }

  /** Time from the cycle's begin to an angle. */
  timeTo(theta) {
    return this.motion.at(theta).time - this.begin;
  }

  /** By how much the crank is ahead of a ring that turns evenly [rad], at an angle. */
  leadAt(theta) {
    const place = ((theta - this.from) / (this.to - this.from)) * POINTS;
    const k = Math.min(Math.max(Math.floor(place), 0), POINTS - 1);
    return this.leads[k] + (this.leads[k + 1] - this.leads[k]) * (place - k);
  }
}

/** By how much the crank is ahead at the samples [rad], on average over the cycle not at all. */
function leadsOf({ samples, angles, from, mean, begin }) {
  const leads = samples.map((v, k) => angles[k] - from - mean * (v.time - begin));
  const middle = leads.slice(1).reduce((sum, each) => sum + each, 0) / (leads.length - 1);
  return leads.map((each) => each - middle);
}
