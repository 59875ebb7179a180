/** A cycle that is shown: computed quickly as a knob moves, well afterwards, and posed. */
import { cycleOf } from "./cycle.js";
import { dragged } from "./drag.js";
import { Engine } from "./engine.js";
import { DEGREE } from "./format.js";
import { deadCentres } from "./geometry.js";
import { Knobs } from "./knobs.js";
import { Player } from "./player.js";
import { refusalOf } from "./refused.js";
import { Stage } from "./stage.js";
import { write } from "./svg.js";
import { deadCentreMarks } from "./words.js";

const LATER = 100; // ms after a knob is let go: the second pass

/** What the page and a lesson's figures have in common. They have `compute()`, `redraw()`, `plots`,
 * `say(sentence, whether the picture is another one)`, `hold()` for a hand and `release()`. */
export class Shown {
  /** given : what Python wrote into the page; turned : the knobs that it has, of those; part(name):
   * an element, or null; words : of the button that plays */
  constructor(given, turned, part, words = {}) {
    Object.assign(this, { given, turned, part, values: {} });
    Object.assign(this, { cycle: null, theta: null, stage: null });
    this.quick = new Engine(given.rules);
    this.careful = new Engine(given.rules);
    const [cycle, move] = [() => this.cycle, (theta) => this.pose(theta)];
    this.player = new Player({ cycle, move, button: part("play"), ...words });
    part("play")?.addEventListener("click", () => this.toggle());
    part("angle")?.addEventListener("input", ({ target }) => this.grasp(Number(target.value)));
    part("angle")?.addEventListener("change", () => this.release());
  }

  /** Make the knobs { knobs, sentences, first }. */
  listenTo(root, knobs) {
    this.knobs = new Knobs(root, knobs, {
      turn: (name, value) => this.turn(name, value),
      release: () => this.release(),
      refuse: (sentence) => this.say(sentence),
    });
  }

  /** Give a knob a value; without one, the scene's own. */
  turn(name, value) {
    const { [name]: _, ...others } = this.values;
    this.values = value === undefined ? others : { ...others, [name]: value };
    this.update();
  }

  /** Compute and draw; where it cannot be, keep the last good picture and say why. */
  update() {
    const reason = refusalOf(() => this.compute());
    this.say(reason ?? "", reason !== null);
    if (reason === null) this.redraw();
  }

  /** Compute the cycle of a scene quickly. */
  take(scene) {
    this.cycle = cycleOf(this.quick, scene, this.given.endings, { warm: this.cycle });
    clearTimeout(this.later);
  }

  /** The second pass, unless it was: cells are cut until they are good, and there are measures. */
  refineLater() {
    clearTimeout(this.later);
    const rough = this.cycle && !this.cycle.measures;
    if (rough) this.later = setTimeout(() => this.refine(), LATER);
  }

  /** The second pass, and how far the first was off. */
  refine() {
    const { cycle: quick, given: { endings } } = this;
    this.cycle = cycleOf(this.careful, quick.scene, endings, { fine: true, warm: quick });
    const apart = this.cycle.rows.map(({ omega }, k) => Math.abs(omega - quick.rows[k].omega));
    this.error = Math.max(...apart) / Math.abs(this.cycle.mean);
    this.redraw();
  }

  /** Show the mechanism in an svg. */
  draggedOn(svg) {
    this.stage = new Stage(svg, this.given.compression, () => this.cycle && this.redraw());
    dragged(this.stage, {
      theta: () => this.theta,
      turn: (theta) => this.seek(theta),
      rim: (ratio) => this.turnRim(ratio),
      grip: (kind) => kind !== "rim" && this.hold(),
      release: () => this.release(),
    });
  }

  /** Draw the mechanism with the forces on a body of cylinder k; the dead centres of that. */
  drawStage(k, body) {
    const { cycle, stage, given: { scene: { crank: { inertia: own } } } } = this;
    const ratio = own > 0 ? cycle.scene.crank.inertia / own : 1;
    stage?.show(cycle, { k, body, ratio, heavy: own > 0 && this.flywheel !== undefined });
    return deadCentreMarks(cycle, k, deadCentres(cycle.train.gears[k].shape));
  }

  get flywheel() {
    return this.turned.find(({ name }) => name === "flywheel");
  }

  /** Give the flywheel a ratio of its inertia to the scene's own, between the ends of its knob. */
  turnRim(ratio) {
    const { low, high } = this.flywheel;
    const own = this.given.scene.crank.inertia;
    this.turn("flywheel", Math.min(Math.max(ratio * own, low), high));
    this.knobs.show(this.values);
  }

  /** Turn to a crank angle [deg] that a hand wants; null where it lets go. */
  grasp(degrees) {
    if (degrees === null) return this.release();
    this.hold();
    return this.seek(degrees * DEGREE);
  }

  /** Turn to a crank angle [rad], back into the cycle that is shown. */
  seek(theta) {
    this.pose(this.cycle.within(theta));
    this.player.seek(this.theta);
  }

  pose(theta) {
    const { stage, part } = this;
    this.theta = theta;
    const degrees = theta / DEGREE;
    stage?.pose(theta);
    for (const plot of this.plots) plot.place(degrees);
    if (part("lead")) write(part("lead"), stage.leadInWords(theta));
    if (!part("angle")) return;
    part("angle").value = degrees;
    write(part("degrees"), `${degrees.toFixed(0)}°`);
    part("angle").setAttribute("aria-valuetext", part("degrees").textContent);
  }

  play(wanted) {
    this.player.play(wanted, this.theta);
  }

  toggle() {
    this.play(!this.player.playing);
  }

  /** Whether one wants nothing to move by itself. */
  get still() {
    return matchMedia("(prefers-reduced-motion: reduce)").matches;
  }
}
