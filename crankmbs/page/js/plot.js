/** One plot: curves over the crank angle with a strip of their differences, or a diagram.
 *
 * It is drawn in pixels of the page, so that its type has the size of the page's; the cursor can
 * be dragged, and what lies under the pointer is read out.
 */
import { drawAxes, drawMarks, frameOf, valueUnder } from "./axis.js";
import { DEGREE, decimalsFor, padded, readable } from "./format.js";
import { rangeOf, sizeOf, valueAlong } from "./shapes.js";
import { slid } from "./slide.js";
import { Pen, add, lineOf, listed, set, watched, write } from "./svg.js";

const STRIP = 0.3; // of the height, for the differences
const NOTHING = 1e-9; // of the largest value: a difference that is none
const NONE = "no difference but rounding";

export class Plot {
  /** root : a figure with .legend and svg; onMove : of the crank angle [deg] that is asked for, or
   * null where a hand lets go */
  constructor(root, onMove) {
    Object.assign(this, { root, onMove, shape: null, ghost: null, hover: null, size: null });
    [this.svg, this.legend] = ["svg", ".legend"].map((part) => root.querySelector(part));
    this.degrees = 0;
    this.axes = { upper: add(this.svg, "g"), lower: add(this.svg, "g") };
    this.lines = add(this.svg, "g", { transform: "scale(0.1)" });
    this.cursor = add(this.svg, "g", { class: "cursor" });
    watched(this.svg, (size) => {
      this.size = size;
      this.redraw();
    });
    slid(this.svg, {
      press: () => this.overAngle(),
      move: (event) => {
        this.hover = null;
        this.onMove(valueUnder(event, this.svg, this.upper));
      },
      hover: (event) => this.overAngle() && this.point(valueUnder(event, this.svg, this.upper)),
      release: () => this.onMove(null),
    });
    this.svg.addEventListener("pointerleave", () => this.point(null));
  }

  /** Draw other curves: { shape, marks } with the shape of `quantities.drawn`. It may also hold
   * values in the range of its axes, `holds` and `holdsBelow`, and its curves have a style. The
   * cursor stands where it was until it is placed. */
  draw(shape, marks) {
    Object.assign(this, { shape, marks });
    const most = sizeOf([shape.curves[0].y, shape.holds?.y ?? []]);
    this.above = shape.curves.map((each, n) => ({ ...each, style: styleOf(each, n), most }));
    const size = sizeOf(shape.curves.map(({ y }) => y));
    this.below = shape.differences
      .map((each, n) => ({ ...each, style: `difference${n}`, most: sizeOf([each.y]) }))
      .filter((each) => each.most > NOTHING * size);
    this.root.classList.toggle("diagram", isDiagram(shape));
    this.root.classList.toggle("square", Boolean(shape.equal));
    this.root.classList.toggle("apart", shape.differences.length > 0);
    if (this.ghost && this.ghost.title !== shape.title) this.ghost = null;
    this.trace();
  }

  /** Keep the curve of the run as it is, or let it go. */
  pin() {
    const [{ x, y }] = this.above;
    const { title } = this.shape;
    this.ghost = this.ghost ? null : { title, x, y, name: "pinned", style: "ghost" };
    this.redraw();
    return this.ghost !== null;
  }

  redraw() {
    this.trace();
    this.place(this.degrees);
  }

  /** Axes and curves. */
  trace() {
    const { svg, shape, size, above, below, ghost } = this;
    if (!shape || !size || size.width < 50 || size.height < 50) return;
    const { width, height, type } = size;
    set(svg, { viewBox: `0 0 ${width} ${height}`, "aria-label": this.described() });
    this.type = type;
    const strip = shape.differences.length > 0;
    const overAngle = !isDiagram(shape);
    const foot = height - (overAngle ? 1.5 : 2.6) * type;
    const split = strip ? foot - STRIP * height : foot;
    const box = { left: 4.4 * type, right: width - 1.7 * type, top: 1.3 * type };
    const top = { ...box, bottom: strip ? split - 1.5 * type : foot };
    const curves = ghost ? [ghost, ...above] : above;
    const about = { type, shape, overAngle, left: box.left };
    this.upper = frameOf(top, curves, { ...about, holds: shape.holds });
    this.draws("upper", this.upper, { ...about, last: !strip, name: nameOf(shape) });
    const low = { ...box, top: split, bottom: foot };
    this.lower = strip ? frameOf(low, below, { ...about, holds: { y: shape.holdsBelow } }) : null;
    this.draws("lower", this.lower, { ...about, last: true, name: "difference" });
    const pen = new Pen(this.lines);
    for (const [frame, all] of [[this.upper, curves], [this.lower, below]]) {
      for (const each of all) {
        pen.add("path", { d: lineOf(each, frame), class: `curve ${each.style}` });
      }
    }
    pen.end();
  }

  /** Draw axes anew where they differ from those that stand there. */
  draws(name, frame, about) {
    const group = this.axes[name];
    if (frame === null) group.replaceChildren();
    const { type, last, name: title, overAngle, shape: { right } } = about;
    const as = frame && JSON.stringify([frame, type, last, title, overAngle, right]);
    if (frame && group.drawn !== as) drawAxes(group, frame, about);
    if (frame) drawMarks(group, frame, overAngle ? this.marks : []);
    group.drawn = as;
  }

  /** Put the cursor at a crank angle [deg]. */
  place(degrees) {
    this.degrees = degrees;
    const { shape, cursor, upper, lower } = this;
    if (!shape || !upper) return;
    const pen = new Pen(cursor);
    const at = this.hover ?? degrees;
    if (isDiagram(shape)) {
      const [x, y] = shape.of(at * DEGREE);
      const end = { x2: upper.right(x), y2: upper.up(y) };
      if (shape.equal) pen.add("line", { x1: upper.right(0), y1: upper.up(0), ...end });
      pen.add("circle", { cx: end.x2, cy: end.y2, r: 0.35 * this.type });
    } else {
      const x = upper.right(degrees);
      const bottom = (lower ?? upper).box.bottom;
      pen.add("line", { x1: x, x2: x, y1: upper.box.top, y2: bottom });
      const value = shape.of(degrees * DEGREE);
      pen.add("circle", { cx: x, cy: upper.up(value), r: 0.3 * this.type });
      if (this.hover !== null) {
        const h = upper.right(at);
        pen.add("line", { x1: h, x2: h, y1: upper.box.top, y2: bottom, class: "hover" });
      }
    }
    pen.end();
    this.read(at);
  }

  /** Write the values at an angle [deg] into the legend. */
  read(degrees) {
    const { shape, legend, above, below, ghost } = this;
    const [run] = above;
    const valued = (each) => {
      const value = each === run ? shape.of(degrees * DEGREE) : between(each, degrees);
      return padded(value, decimalsFor(each.most), each.most);
    };
    const entries = [...above, ...below].map((each) =>
      [each.name, each.style, isDiagram(shape) ? "" : valued(each)]);
    if (shape.differences.length && !below.length) entries.push([NONE, "", ""]);
    if (ghost) entries.push([ghost.name, ghost.style, ""]);
    const hovers = this.hover !== null && !isDiagram(shape);
    if (hovers) entries.unshift([`at ${readable(degrees, 0)}°`, "", ""]);
    const items = listed(legend, entries.length, ["span", "entry"], ["i", "span", "b"]);
    entries.forEach(([name, style, value], n) => {
      const [swatch, called, number] = items[n].children;
      set(swatch, { class: style ? `swatch ${style}` : "none" });
      write(called, value ? `${name} ` : name);
      write(number, value);
    });
  }

  /** Whether a curve over the crank angle is drawn. */
  overAngle() {
    return Boolean(this.upper) && !isDiagram(this.shape);
  }

  point(degrees) {
    this.hover = degrees;
    this.place(this.degrees);
  }

  described() {
    const { shape, above: [{ y, most }] } = this;
    const [low, high] = rangeOf([y]).map((each) => readable(each, decimalsFor(most)));
    return `${shape.title}: ${low} to ${high} ${shape.up.unit}, over the ${shape.right.text}`;
  }
}

function isDiagram(shape) {
  return shape.right.text !== "crank angle";
}

function styleOf({ name, style }, n) {
  if (style) return style;
  return n === 0 ? "simulated" : name === "lecture" ? "lecture" : "exact";
}

function nameOf({ up, right }) {
  if (right.text === "crank angle") return up.unit;
  return up.unit ? `${up.text} [${up.unit}]` : up.text;
}

/** The value of a curve at an angle, between its points. */
function between({ x, y }, degrees) {
  return valueAlong(y, (degrees - x[0]) / (x[x.length - 1] - x[0]));
}
