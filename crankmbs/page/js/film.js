/** The film: a run that Python computed, replayed over time. */
import { RPM, readable } from "./format.js";
import { valuesOf } from "./given.js";
import { enlarge, find, listenToKeys } from "./keys.js";
import { Player } from "./player.js";
import { Stage } from "./stage.js";
import { write } from "./svg.js";
import { TimePlot } from "./time_plot.js";
import { Track } from "./track.js";

const SECONDS = 28; // that the film takes at first
const POWERS = [0.001, 0.01, 0.1, 1, 10, 100, 1000, 1e4];
const RATES = POWERS.flatMap((power) => [1, 2, 5].map((each) => each * power));
const SLOWEST = 8; // choices of slow motion beyond the first: 500 times slower

/** Begin with what Python wrote into the page. */
export function start() {
  return new Film(valuesOf(JSON.parse(find("given").textContent)));
}

class Film {
  constructor(given) {
    this.track = new Track(given);
    this.time = this.track.begin;
    this.stage = new Stage(find("stage"), given.compression, () => this.fit());
    const { begin, end } = this.track;
    const speedAt = (time) => this.track.motionAt(time).speed / RPM;
    this.plot = new TimePlot(find("upper"), given, { speedAt, move: (time) => this.take(time) });
    // the player's angle is the time itself
    const run = { duration: end - begin, timeTo: (t) => t - begin, angleAt: (t) => t + begin };
    const finish = () => this.play(false);
    const [move, button] = [(time) => this.pose(time), find("play")];
    this.player = new Player({ cycle: () => run, move, button, finish });
    Object.assign(find("time"), { min: begin, max: end });
    this.offer(end - begin);
    this.listen();
    this.fit();
    this.play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
  }

  /** Offer slow motion, from the rate at which the film takes some seconds. */
  offer(duration) {
    this.player.slower = this.first = Player.fitting(duration, RATES, SECONDS);
    const n = RATES.indexOf(this.first);
    const rates = RATES.slice(n, n + SLOWEST + 1);
    Player.offer(find("slower"), (rate) => this.slow(rate), this.first, rates);
  }

  /** Play so many times slower; of the run as small a part is then plotted. */
  slow(rate) {
    this.player.slower = rate;
    this.plot.divide(Math.round(rate / this.first));
  }

  listen() {
    find("play").addEventListener("click", () => this.play(!this.player.playing));
    find("time").addEventListener("input", ({ target }) => this.take(Number(target.value)));
    find("large").addEventListener("click", enlarge);
    const { begin, end } = this.track;
    listenToKeys({
      play: () => this.play(!this.player.playing),
      step: (sign, fine) => this.take(this.time + (sign * (end - begin)) / (fine ? 1000 : 100)),
      Home: () => this.take(begin),
      End: () => this.take(end),
    });
  }

  fit() {
    this.stage.show(this.track, { k: 0, body: "none", ratio: 1, heavy: false });
    this.pose(this.time);
  }

  /** A hand takes the film to a time [s]. */
  take(time) {
    this.play(false);
    this.pose(Math.min(Math.max(time, this.track.begin), this.track.end));
  }

  pose(time) {
    this.time = time;
    const { angle, speed } = this.track.to(time);
    this.stage.pose(angle);
    this.plot.place(time, speed / RPM);
    this.read(time);
  }

  /** Write time, angle, speed and fuel at a time [s], cut to the digits that are shown of it. */
  read(time) {
    const { track } = this;
    const { decimals, fuel } = track.given;
    const at = track.shown(time);
    const { angle, speed } = track.to(at);
    const degrees = (angle * 180) / Math.PI;
    write(find("now-time"), `${readable(at, decimals.time)} s`);
    write(find("now-angle"), `${readable(degrees, decimals.angle)}°`);
    write(find("now-speed"), `${readable(speed / RPM, decimals.speed)} rpm`);
    if (fuel) write(find("now-fuel"), `fuel ${readable(track.fuelAt(at) ?? NaN, 2)}`);
    find("time").value = time;
    find("time").setAttribute("aria-valuetext", `${readable(at, decimals.time)} s`);
  }

  /** Play on, from the begin where the film has ended, or pause. */
  play(wanted) {
    this.player.play(wanted, this.time < this.track.end ? this.time : this.track.begin);
  }
}
