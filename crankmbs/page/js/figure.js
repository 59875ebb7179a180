/** A figure of a lesson: the mechanism, curves, sliders, and words that follow them. */
import { DEGREE } from "./format.js";
import { Player } from "./player.js";
import { Plot } from "./plot.js";
import { Shown } from "./shown.js";
import { Pen, add, watched, write } from "./svg.js";
import { spanOf, tellingPose } from "./view.js";

/** One figure.
 *
 * root : its element; lesson : { given, turner }; spec : what Python says of it, { knobs, choices,
 * values, forces, cylinder, angle, ring }; made : what its lesson computes,
 * { scene(turner, values, given), shapes(cycle, values, given), says(cycle, values, given),
 * levels(cycle), draw(svg, cycle, theta, size) }, each but shapes may be left out
 */
export class Figure extends Shown {
  constructor(root, { given, turner }, spec, made) {
    const part = (name) => root.querySelector(`.${name}`);
    super(given, spec.knobs, part, { still: "►", moving: "❚❚" });
    Object.assign(this, { root, turner, spec, made, values: { ...spec.values } });
    this.stopped = false; // by hand
    this.listen();
    this.update();
  }

  listen() {
    const { spec, given: { sentences }, root, part } = this;
    this.listenTo(part("sliders"), { knobs: spec.knobs, sentences });
    for (const select of root.querySelectorAll("select[data-choice]")) {
      select.value = this.values[select.dataset.choice];
      select.addEventListener("change", () => this.turn(select.dataset.choice, select.value));
    }
    const plots = [...root.querySelectorAll(".plot")];
    this.plots = plots.map((each) => new Plot(each, (degrees) => this.grasp(degrees)));
    if (part("stage")) this.draggedOn(part("stage"));
    if (part("drawing")) {
      watched(part("drawing"), (size) => {
        this.size = size;
        if (this.cycle) this.pose(this.theta);
      });
    }
  }

  toggle() {
    this.stopped = this.player.playing;
    super.toggle();
  }

  /** Play while it is seen, unless it was stopped by hand. */
  seen(visible) {
    if (!this.part("play") || this.cycle === null) return;
    this.play(visible && !this.still && !this.stopped);
  }

  /** Stop for a hand. */
  hold() {
    this.stopped = true;
    if (this.part("play")) this.play(false);
  }

  release() {}

  compute() {
    const { given, turner, made, values } = this;
    this.take(made.scene ? made.scene(turner, values, given) : turner.scene(values));
    this.refineLater();
  }

  redraw() {
    const { cycle, spec, given, made } = this;
    const k = Math.min(spec.cylinder, cycle.train.cylinders.length) - 1;
    const marks = this.drawStage(k, spec.forces);
    if (made.levels) this.drawLevels(made.levels(cycle));
    const shapes = made.shapes(cycle, this.values, given);
    this.plots.forEach((plot, n) => plot.draw(shapes[n], marks));
    this.player.slower = Player.fitting(cycle.duration);
    this.speak();
    const { low, high } = spanOf(cycle);
    Object.assign(this.part("angle") ?? {}, { min: low, max: high });
    const first = spec.angle === null ? tellingPose(cycle) : spec.angle * DEGREE;
    this.seek(this.theta ?? first);
    this.root.dataset.passes = cycle.measures ? "2" : "1";
  }

  /** Write what follows the sliders into the words around, { name: text }. */
  speak() {
    const { made, cycle, values, root, given } = this;
    if (!made.says) return;
    for (const [name, text] of Object.entries(made.says(cycle, values, given))) {
      for (const place of document.querySelectorAll(`[data-say="${root.id}.${name}"]`)) {
        write(place, text);
      }
    }
  }

  /** Dashed lines across the first cylinder at piston positions, each [m, name]. */
  drawLevels(levels) {
    const { stage } = this;
    if (!this.levels?.isConnected) this.levels = add(stage.root, "g", { class: "levels" });
    const pen = new Pen(this.levels);
    const half = 650 * stage.sizes.each[0].width;
    const middle = -1000 * stage.train.shape.offset;
    for (const [x, name] of levels) {
      const y = -1000 * x;
      pen.add("line", { x1: middle - half, x2: middle + half, y1: y, y2: y });
      const at = { x: middle + 1.05 * half, y: y + 0.3 * stage.type, "font-size": stage.type };
      pen.add("text", at, name);
    }
    pen.end();
  }

  pose(theta) {
    super.pose(theta);
    if (this.size) this.made.draw(this.part("drawing"), this.cycle, theta, this.size);
  }

  say(sentence) {
    const message = this.part("message");
    message.textContent = sentence;
    message.hidden = sentence === "";
  }
}
