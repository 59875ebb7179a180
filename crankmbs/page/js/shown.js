/** A cycle that is shown: computed quickly as a knob moves, well afterwards, and posed. */
import { cycleOf } from "./cycle.js";
import { dragged } from "./drag.js";
import { Engine } from "./engine.js";
import { deadCentres } from "./geometry.js";
import { Stage } from "./stage.js";
import { deadCentreMarks } from "./words.js";

const LATER = 100; // ms after a knob is let go: the second pass

/** What the page and a lesson's figures have in common. They have `turn(name, value)`, `redraw()`,
 * `refine()` and `pose(theta)`, and a `player` and `knobs`. */
export class Shown {
  /** given : what Python wrote into the page; turned : the knobs that it has, of those */
  constructor(given, turned) {
    Object.assign(this, { given, turned, values: {}, cycle: null, theta: null, stage: null });
    this.quick = new Engine(given.rules);
    this.careful = new Engine(given.rules);
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

  refined() {
    const { cycle, given: { endings } } = this;
    return cycleOf(this.careful, cycle.scene, endings, { fine: true, warm: cycle });
  }

  /** Show the mechanism in an svg; a hand that takes it stops the player by hold(). */
  draggedOn(svg, hold, release) {
    this.stage = new Stage(svg, this.given.compression, () => this.cycle && this.redraw());
    dragged(this.stage, {
      theta: () => this.theta,
      turn: (theta) => this.seek(theta),
      rim: (ratio) => this.turnRim(ratio),
      grip: (kind) => kind !== "rim" && hold(),
      release,
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

  /** Turn to a crank angle [rad], back into the cycle that is shown. */
  seek(theta) {
    this.pose(this.cycle.within(theta));
    this.player.seek(this.theta);
  }

  play(wanted) {
    this.player.play(wanted, this.theta);
  }
}
