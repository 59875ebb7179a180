/** Lets the crank turn as fast as the run has it, so many times slower. */
import { set, write } from "./svg.js";

const SECONDS = 7; // that a cycle takes at first
const SLOWER = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000];

export class Player {
  /** on : { cycle() the cycle shown, move(theta), button that says by two words whether it plays,
   * still and moving }, and finish() of what does not begin again */
  constructor(on) {
    Object.assign(this, { on, playing: false, slower: null });
    this.turn = this.turn.bind(this);
  }

  /** The factor of slow motion at which a time [s] takes some seconds, out of several. */
  static fitting(duration, factors = SLOWER, seconds = SECONDS) {
    const far = (factor) => Math.abs(Math.log((factor * duration) / seconds));
    return factors.reduce((best, each) => (far(each) < far(best) ? each : best));
  }

  /** Fill a select with factors of slow motion, of which it begins with `first`, which is given
   * back; chosen(factor) when another is. */
  static offer(select, chosen, first, factors = SLOWER) {
    const named = (rate) => (rate > 1 ? `${rate}× slower` : `${Math.round(1 / rate)}× faster`);
    for (const rate of factors) {
      select.append(new Option(rate === 1 ? "real time" : named(rate), String(rate)));
    }
    select.value = String(first);
    select.addEventListener("change", () => chosen(Number(select.value)));
    return first;
  }

  play(wanted, theta) {
    if (wanted && !this.playing) {
      this.time = this.on.cycle().timeTo(theta);
      this.before = null;
      requestAnimationFrame(this.turn);
    }
    this.playing = wanted;
    const { button, still = "► play", moving = "❚❚ pause" } = this.on;
    write(button, wanted ? moving : still);
    set(button, { "aria-pressed": String(wanted) });
  }

  /** Go on from another angle. */
  seek(theta) {
    if (this.playing) this.time = this.on.cycle().timeTo(theta);
  }

  turn(now) {
    if (!this.playing) return;
    const passed = this.before === null ? 0 : Math.min(now - this.before, 100) / 1000;
    this.before = now;
    const cycle = this.on.cycle();
    this.time += passed / this.slower;
    const ends = this.on.finish && this.time >= cycle.duration;
    this.time = ends ? cycle.duration : this.time % cycle.duration;
    this.on.move(cycle.angleAt(this.time));
    if (ends) this.on.finish();
    else requestAnimationFrame(this.turn);
  }
}
