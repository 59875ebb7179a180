/** A figure of a lesson: the mechanism, curves, sliders, and words that follow them. */
import { Knobs } from "./knobs.js";
import { Player } from "./player.js";
import { Plot } from "./plot.js";
import { Refused } from "./refused.js";
import { Shown } from "./shown.js";
import { Pen, add, watched, write } from "./svg.js";
import { spanOf, tellingPose } from "./view.js";

const DEGREE = Math.PI / 180;

/** One figure.
 *
 * root : its element; lesson : { given, turner }; spec : what Python says of it, { knobs, choices,
 * values, forces, cylinder, angle, ring }; made : what its lesson computes,
 * { scene(turner, values, given), shapes(cycle, values, given), says(cycle, values, given),
 * levels(cycle), draw(svg, cycle, theta, size) }, each but shapes may be left out
 */
export class Figure extends Shown {
  constructor(root, { given, turner }, spec, made) {
    super(given, spec.knobs);
    Object.assign(this, { root, turner, spec, made, values: { ...spec.values } });
    this.stopped = false; // by hand
    const [move, button] = [(theta) => this.pose(theta), this.find(".play")];
    const words = { still: "►", moving: "❚❚" };
    this.player = new Player({ cycle: () => this.cycle, move, button, ...words });
    this.listen();
    this.update();
  }

  find(selector) {
    return this.root.querySelector(selector);
  }

  listen() {
    const { spec, given: { sentences }, root } = this;
    this.knobs = new Knobs(this.find(".sliders"), { knobs: spec.knobs, sentences }, {
      turn: (name, value) => this.turn(name, value),
      release: () => {},
      refuse: (sentence) => this.say(sentence),
    });
    for (const select of root.querySelectorAll("select[data-choice]")) {
      select.value = this.values[select.dataset.choice];
      select.addEventListener("change", () => this.turn(select.dataset.choice, select.value));
    }
    const plots = [...root.querySelectorAll(".plot")];
    this.plots = plots.map((each) => new Plot(each, (degrees) => this.grasp(degrees)));
    const stage = this.find(".stage");
    if (stage) this.draggedOn(stage, () => this.hold(), () => {});
    const drawing = this.find(".drawing");
    if (drawing) {
      watched(drawing, (size) => {
        this.size = size;
        if (this.cycle) this.pose(this.theta);
      });
    }
    this.find(".play")?.addEventListener("click", () => {
      this.stopped = this.player.playing;
      this.play(!this.player.playing);
    });
    const grasp = (event) => this.grasp(Number(event.target.value));
    this.find(".angle")?.addEventListener("input", grasp);
  }

  /** Play while it is seen, unless it was stopped by hand. */
  seen(visible) {
    if (!this.find(".play") || this.cycle === null) return;
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.play(visible && !still && !this.stopped);
  }

  /** Stop for a hand. */
  hold() {
    this.stopped = true;
    if (this.find(".play")) this.play(false);
  }

  /** Turn to a crank angle [deg] that a hand wants; null where it lets go. */
  grasp(degrees) {
    if (degrees === null) return;
    this.hold();
    this.seek(degrees * DEGREE);
  }

  turn(name, value) {
    this.values = { ...this.values, [name]: value };
    this.update();
  }

  /** Compute and draw; where it cannot be, keep the last good picture and say why. */
  update() {
    const { given, turner, made, values } = this;
    try {
      this.take(made.scene ? made.scene(turner, values, given) : turner.scene(values));
      this.say("");
    } catch (refused) {
      if (!(refused instanceof Refused)) throw refused;
      this.say(refused.message);
      return;
    }
    this.refineLater();
    this.root.dataset.passes = "1";
    this.redraw();
  }

  /** The second pass. */
  refine() {
    this.cycle = this.refined();
    this.redraw();
    this.root.dataset.passes = "2";
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
    const angle = this.find(".angle");
    if (angle) Object.assign(angle, { min: low, max: high });
    const first = spec.angle === null ? tellingPose(cycle) : spec.angle * DEGREE;
    this.seek(this.theta ?? first);
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
    this.theta = theta;
    const degrees = theta / DEGREE;
    this.stage?.pose(theta);
    if (this.size) this.made.draw(this.find(".drawing"), this.cycle, theta, this.size);
    for (const plot of this.plots) plot.place(degrees);
    const lead = this.find(".lead");
    if (lead) write(lead, this.spec.ring ? this.stage.leadInWords(theta) : "");
    const angle = this.find(".angle");
    if (!angle) return;
    angle.value = degrees;
    const text = `${degrees.toFixed(0)}°`;
    angle.setAttribute("aria-valuetext", text);
    write(this.find(".degrees"), text);
  }

  say(sentence) {
    const message = this.find(".message");
    message.textContent = sentence;
    message.hidden = sentence === "";
  }
}
