/** The page: knobs, mechanism and plots of one scene, and what happens between them. */
import {
  fillChoices, listenToChoices, say, seenPlots, showChoices, showWords, unfold,
} from "./controls.js";
import { DEGREE } from "./format.js";
import { valuesOf } from "./given.js";
import { enlarge, find, listenToKeys } from "./keys.js";
import { Player } from "./player.js";
import { Plot } from "./plot.js";
import { drawn } from "./quantities.js";
import { refusalOf } from "./refused.js";
import { Shown } from "./shown.js";
import { Address } from "./state.js";
import { dataFile, save } from "./taken.js";
import { Turner } from "./turned.js";
import { firstView, keysOf, tellingPose } from "./view.js";

const PLOTS = ["upper", "lower"];

/** Begin with what Python wrote into the page. */
export function start() {
  return new Page(valuesOf(JSON.parse(document.getElementById("given").textContent)));
}

class Page extends Shown {
  constructor(given) {
    super(given, given.knobs, find);
    this.turner = new Turner(given);
    this.view = firstView(given);
    this.address = new Address(keysOf(given), given.sentences);
    this.listen();
    this.begin();
  }

  listen() {
    this.listenTo(find("sliders"), this.given);
    this.draggedOn(find("stage"));
    this.plots = PLOTS.map((name) => this.plot(find(name)));
    listenToChoices((name, value) => {
      if (name in this.view) this.view = { ...this.view, [name]: value };
      this.turn(name, name in this.view ? undefined : value);
      this.release();
    });
    const pressed = {
      reset: () => this.reset(),
      csv: () => save(...dataFile(this.given, this.cycle)),
      large: enlarge,
      more: () => { unfold(); this.redraw(); },
    };
    for (const [id, does] of Object.entries(pressed)) find(id).addEventListener("click", does);
    listenToKeys({
      play: () => this.toggle(),
      step: (sign, far) => {
        this.grasp(Math.round(this.theta / DEGREE) + sign * (far ? 10 : 1));
        this.release();
      },
    });
    addEventListener("hashchange", () => this.open(location.hash));
  }

  plot(root) {
    const plot = new Plot(root, (degrees) => this.grasp(degrees));
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
    this.play(!this.still);
  }

  /** Show the state that an address says; what cannot be leaves the page as it is. */
  open(address) {
    const { values, view } = this;
    const reason = refusalOf(() => {
      const state = this.address.read(address);
      this.view = { ...firstView(this.given) };
      this.values = {};
      for (const [name, value] of Object.entries(state)) {
        (name in this.view ? this.view : this.values)[name] = value;
      }
      const begun = [...this.given.first, "angle"];
      if (Object.keys(state).some((name) => !begun.includes(name))) unfold(true);
      this.compute();
    });
    if (reason !== null) Object.assign(this, { values, view });
    say(reason ?? "");
    this.knobs.show(this.values);
    this.redraw();
    this.refineLater();
    if (this.view.angle !== null) this.grasp(this.view.angle);
  }

  say(sentence, stale) {
    say(sentence, stale);
  }

  hold() {
    this.play(false);
  }

  reset() {
    this.values = {};
    this.view = { ...firstView(this.given), angle: this.view.angle };
    this.knobs.show({});
    this.update();
    this.release();
  }

  compute() {
    this.take(this.turner.scene(this.values));
    Object.assign(this, { good: this.values, error: null });
  }

  redraw() {
    const { cycle, given, view } = this;
    if (!cycle) return;
    const k = Math.min(Number(view.cylinder), cycle.train.cylinders.length) - 1;
    const marks = this.drawStage(k, view.forces);
    for (const name of seenPlots()) {
      this.plots[PLOTS.indexOf(name)].draw(drawn(view[name], cycle, k), marks);
    }
    showChoices(given, cycle, { ...given.own, ...view, ...this.values, cylinder: String(k + 1) });
    const unused = cycle.prescribed && given.scene.motion === null ? ["flywheel", "load"] : [];
    this.knobs.disable(unused);
    const { player } = this;
    const chosen = (slower) => (player.slower = slower);
    player.slower ??= Player.offer(find("slower"), chosen, Player.fitting(cycle.duration));
    showWords(given, cycle, this.error);
    this.seek(this.theta ?? tellingPose(cycle));
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
