/** The page: knobs, mechanism and plots of one scene, and what happens between them. */
import { fillChoices, listenToChoices, showChoices, showSlower } from "./controls.js";
import { say, seenPlots, showWords, unfold, unused } from "./controls.js";
import { valuesOf } from "./given.js";
import { enlarge, find, listenToKeys } from "./keys.js";
import { Knobs } from "./knobs.js";
import { Player } from "./player.js";
import { Plot } from "./plot.js";
import { drawn } from "./quantities.js";
import { Refused } from "./refused.js";
import { Shown } from "./shown.js";
import { Address } from "./state.js";
import { write } from "./svg.js";
import { dataFile, save } from "./taken.js";
import { Turner } from "./turned.js";
import { firstView, keysOf, tellingPose } from "./view.js";

const DEGREE = Math.PI / 180;
const PLOTS = ["upper", "lower"];

/** Begin with what Python wrote into the page. */
export function start() {
  return new Page(valuesOf(JSON.parse(document.getElementById("given").textContent)));
}

class Page extends Shown {
  constructor(given) {
    super(given, given.knobs);
    this.turner = new Turner(given);
    this.view = firstView(given);
    this.address = new Address(keysOf(given), given.sentences);
    const move = (theta) => this.pose(theta);
    this.player = new Player({ cycle: () => this.cycle, move, button: find("play") });
    this.listen();
    this.begin();
  }

  listen() {
    const { given } = this;
    this.knobs = new Knobs(find("sliders"), given, {
      turn: (name, value) => this.turn(name, value),
      release: () => this.release(),
      refuse: say,
    });
    this.draggedOn(find("stage"), () => this.play(false), () => this.release());
    this.plots = Object.fromEntries(PLOTS.map((name) => [name, this.plot(name)]));
    listenToChoices((name, value) => {
      if (name in this.view) this.view = { ...this.view, [name]: value };
      this.turn(name, name in this.view ? undefined : value);
      this.release();
    });
    this.press("play", () => this.play(!this.player.playing));
    this.press("reset", () => this.reset());
    this.press("csv", () => save(...dataFile(given, this.cycle)));
    this.press("large", enlarge);
    this.press("more", () => { unfold(); this.redraw(); });
    find("angle").addEventListener("input", (event) => {
      this.play(false);
      this.seek(Number(event.target.value) * DEGREE);
    });
    find("angle").addEventListener("change", () => this.release());
    listenToKeys({
      play: () => this.play(!this.player.playing),
      step: (sign, far) => {
        this.play(false);
        this.seek((Math.round(this.theta / DEGREE) + sign * (far ? 10 : 1)) * DEGREE);
        this.release();
      },
    });
    addEventListener("hashchange", () => this.open(location.hash));
  }

  press(id, does) {
    find(id).addEventListener("click", does);
  }

  plot(name) {
    const root = find(name);
    const plot = new Plot(root, (degrees) => {
      if (degrees === null) return this.release();
      this.play(false);
      return this.seek(degrees * DEGREE);
    });
    fillChoices(root.querySelector("select"), this.given.scene);
    const pin = root.querySelector(".pin");
    pin.addEventListener("click", () => pin.setAttribute("aria-pressed", String(plot.pin())));
    return plot;
  }

  begin() {
    this.update();
    if (location.hash.length > 1) this.open(location.hash);
    this.refineLater();
    if (this.cycle === null || this.view.angle !== null) return;
    this.seek(tellingPose(this.cycle));
    this.play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
  }

  /** Show the state that an address says; what cannot be leaves the page as it is. */
  open(address) {
    const { values, view } = this;
    try {
      const state = this.address.read(address);
      this.view = { ...firstView(this.given) };
      this.values = {};
      for (const [name, value] of Object.entries(state)) {
        (name in this.view ? this.view : this.values)[name] = value;
      }
      const begun = [...this.given.first, "angle"];
      if (Object.keys(state).some((name) => !begun.includes(name))) unfold(true);
      this.compute();
      say("");
    } catch (refused) {
      if (!(refused instanceof Refused)) throw refused;
      Object.assign(this, { values, view });
      say(refused.message);
    }
    this.knobs.show(this.values);
    this.redraw();
    this.refineLater();
    if (this.view.angle === null) return;
    this.play(false);
    this.seek(this.view.angle * DEGREE);
  }

  /** Give a knob a value; without one, the scene's own. */
  turn(name, value) {
    const { [name]: _, ...others } = this.values;
    this.values = value === undefined ? others : { ...others, [name]: value };
    this.update();
  }

  reset() {
    this.values = {};
    this.view = { ...firstView(this.given), angle: this.view.angle };
    this.knobs.show({});
    this.update();
    this.release();
  }

  /** Compute and draw; where it cannot be, grey the last good picture and say why. */
  update() {
    try {
      this.compute();
      say("");
    } catch (refused) {
      if (!(refused instanceof Refused)) throw refused;
      return say(refused.message, true);
    }
    return this.redraw();
  }

  compute() {
    this.take(this.turner.scene(this.values));
    Object.assign(this, { good: this.values, error: null });
  }

  /** The second pass, and how far the first was off. */
  refine() {
    const [better, { rows }] = [this.refined(), this.cycle];
    const apart = better.rows.map(({ omega }, k) => Math.abs(omega - rows[k].omega));
    this.error = Math.max(...apart) / Math.abs(better.mean);
    this.cycle = better;
    this.redraw();
  }

  redraw() {
    const { cycle, given, view } = this;
    if (!cycle) return;
    const k = Math.min(Number(view.cylinder), cycle.train.cylinders.length) - 1;
    const marks = this.drawStage(k, view.forces);
    for (const name of seenPlots()) this.plots[name].draw(drawn(view[name], cycle, k), marks);
    showChoices(given, cycle, { ...given.own, ...view, ...this.values, cylinder: String(k + 1) });
    this.knobs.disable(unused(cycle, given));
    this.player.slower = showSlower(cycle, (slower) => {
      this.player.slower = slower;
    });
    showWords(given, cycle, this.error);
    this.seek(this.theta ?? tellingPose(cycle));
  }

  pose(theta) {
    this.theta = theta;
    const degrees = theta / DEGREE;
    this.stage.pose(theta);
    for (const name of PLOTS) this.plots[name].place(degrees);
    find("angle").value = degrees;
    write(find("degrees"), `${degrees.toFixed(0)}°`);
    find("angle").setAttribute("aria-valuetext", find("degrees").textContent);
    write(find("lead"), this.stage.leadInWords(theta));
  }

  /** A hand lets go: refine, and keep in the address what is shown. */
  release() {
    this.refineLater();
    const first = firstView(this.given);
    const view = Object.entries(this.view).filter(([name, value]) => value !== first[name]);
    const state = { ...this.good, ...Object.fromEntries(view) };
    if (!this.player.playing) state.angle = Number((this.theta / DEGREE).toFixed(3));
    history.replaceState(null, "", this.address.write(state));
  }
}
