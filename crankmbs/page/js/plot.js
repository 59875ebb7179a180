/** One plot: curves over the crank angle with a strip of their differences, or a diagram.
 *
 * It is drawn in pixels of the page, so that its type has the size of the page's; the cursor can
 * be dragged, and what lies under the pointer is read out.
 */
import { axes } from "./axis.js";
import { decimalsFor, readable } from "./format.js";
import { add, pathOf, set } from "./svg.js";

const STRIP = 0.3; // of the height, for the differences
const NOTHING = 1e-9; // of the largest value: a difference that is none

export class Plot {
  /** root : a figure with .legend and svg; onMove : of the crank angle [deg] that is asked for */
  constructor(root, onMove) {
    this.root = root;
    this.svg = root.querySelector("svg");
    this.legend = root.querySelector(".legend");
    this.onMove = onMove;
    this.shape = null;
    this.ghost = null;
    this.degrees = 0;
    this.hover = null;
    this.svg.addEventListener("pointerdown", (event) => this.press(event));
    this.svg.addEventListener("pointermove", (event) => this.move(event));
    this.svg.addEventListener("pointerleave", () => this.point(null));
  }

  /** Draw other curves: { shape, marks } with the shape of `quantities.drawn`. */
  draw(shape, marks) {
    this.shape = shape;
    this.marks = marks;
    if (this.ghost && this.ghost.title !== shape.title) this.ghost = null;
    this.redraw();
  }

  /** Keep the curve of the run as it is, or let it go. */
  pin() {
    this.ghost = this.ghost ? null : { title: this.shape.title, curve: this.shape.curves[0] };
    this.redraw();
    return this.ghost !== null;
  }

  redraw() {
    const { svg, shape } = this;
    const { width, height } = svg.getBoundingClientRect();
    if (!shape || width < 50 || height < 50) return;
    svg.replaceChildren();
    set(svg, { viewBox: `0 0 ${width} ${height}`, "aria-label": this.described() });
    const type = parseFloat(getComputedStyle(svg).fontSize);
    const strip = shape.differences.length > 0;
    const foot = height - (isDiagram(shape) ? 2.6 : 1.5) * type;
    const split = strip ? foot - STRIP * height : foot;
    const box = { left: 4.4 * type, right: width - 1.2 * type, top: 1.3 * type };
    const curves = this.ghost ? [...shape.curves, this.ghost.curve] : shape.curves;
    const about = { type, shape, marks: this.marks, overAngle: !isDiagram(shape) };
    this.type = type;
    this.cursor = null;
    const top = { ...box, bottom: strip ? split - 1.5 * type : foot };
    this.upper = axes(svg, top, curves, { ...about, last: !strip, name: nameOf(shape) });
    this.lower = null;
    if (strip) {
      const below = { ...box, top: split, bottom: foot };
      this.lower = axes(svg, below, this.visible(), { ...about, last: true, name: "difference" });
    }
    if (this.ghost) this.line(this.upper, this.ghost.curve, "ghost");
    shape.curves.forEach((curve, n) => this.line(this.upper, curve, styleOf(curve, n)));
    if (strip) this.visible().forEach((each) => this.line(this.lower, each, each.style));
    this.cursor = add(svg, "g", { class: "cursor" });
    this.place(this.degrees);
  }

  /** The differences that are more than rounding. */
  visible() {
    const { curves, differences } = this.shape;
    const size = Math.max(...curves.flatMap(({ y }) => y.map(Math.abs)));
    const styled = differences.map((each, n) => ({ ...each, style: `difference${n}` }));
    return styled.filter(({ y }) => y.some((value) => Math.abs(value) > NOTHING * size));
  }

  line({ right, up }, { x, y }, style) {
    const d = pathOf(x.map((each, k) => [right(each), up(y[k])]));
    add(this.svg, "path", { d, class: `curve ${style}` });
  }

  /** Put the cursor at a crank angle [deg]. */
  place(degrees) {
    this.degrees = degrees;
    const { shape, cursor, upper, lower } = this;
    if (!shape || !cursor) return;
    cursor.replaceChildren();
    const at = this.hover ?? degrees;
    if (isDiagram(shape)) {
      const [x, y] = shape.of((at * Math.PI) / 180);
      add(cursor, "circle", { cx: upper.right(x), cy: upper.up(y), r: 0.35 * this.type });
    } else {
      const x = upper.right(degrees);
      const bottom = (lower ?? upper).box.bottom;
      add(cursor, "line", { x1: x, x2: x, y1: upper.box.top, y2: bottom });
      const value = shape.of((degrees * Math.PI) / 180);
      add(cursor, "circle", { cx: x, cy: upper.up(value), r: 0.3 * this.type });
      if (this.hover !== null) {
        const h = upper.right(at);
        add(cursor, "line", { x1: h, x2: h, y1: upper.box.top, y2: bottom, class: "hover" });
      }
    }
    this.read(at);
  }

  /** Write the values at an angle [deg] into the legend. */
  read(degrees) {
    const { shape, legend } = this;
    const entries = isDiagram(shape)
      ? shape.curves.map(({ name }, n) => [name, styleOf({ name }, n), ""])
      : this.values(degrees);
    if (this.ghost) entries.push(["pinned", "ghost", ""]);
    const hovers = this.hover !== null && !isDiagram(shape);
    const where = hovers ? [[`at ${readable(degrees, 0)}°`, "", ""]] : [];
    const all = [...where, ...entries];
    while (legend.children.length > all.length) legend.lastChild.remove();
    all.forEach(([name, style, value], n) => {
      const item = legend.children[n] ?? legend.appendChild(entry());
      item.children[0].className = style ? `swatch ${style}` : "none";
      item.children[1].textContent = value ? `${name} ` : name;
      item.children[2].textContent = value;
    });
  }

  /** Name, style and value of every curve and difference at an angle [deg]. */
  values(degrees) {
    const { curves, differences } = this.shape;
    const run = this.shape.of((degrees * Math.PI) / 180);
    const decimals = decimalsFor(Math.max(...curves[0].y.map(Math.abs)));
    const styled = curves.map((curve, n) => {
      const value = n === 0 ? run : between(curve, degrees);
      return [curve.name, styleOf(curve, n), readable(value, decimals)];
    });
    if (!differences.length) return styled;
    const seen = this.visible().map((each) => {
      const size = Math.max(...each.y.map(Math.abs));
      return [each.name, each.style, readable(between(each, degrees), decimalsFor(size))];
    });
    return seen.length ? [...styled, ...seen] : [...styled, ["no difference but rounding", "", ""]];
  }

  degreesAt(event) {
    const { left } = this.svg.getBoundingClientRect();
    const { box, x } = this.upper;
    const part = (event.clientX - left - box.left) / (box.right - box.left);
    return x.low + Math.min(Math.max(part, 0), 1) * (x.high - x.low);
  }

  press(event) {
    if (!this.shape || isDiagram(this.shape)) return;
    event.preventDefault();
    this.svg.setPointerCapture?.(event.pointerId);
    this.held = event.pointerId;
    const release = () => {
      this.held = null;
      this.onMove(null);
    };
    this.svg.addEventListener("pointerup", release, { once: true });
    this.svg.addEventListener("pointercancel", release, { once: true });
    this.move(event);
  }

  move(event) {
    if (!this.shape || !this.upper || isDiagram(this.shape)) return;
    const degrees = this.degreesAt(event);
    if (this.held === event.pointerId) {
      this.hover = null;
      this.onMove(degrees);
    } else {
      this.point(degrees);
    }
  }

  point(degrees) {
    this.hover = degrees;
    this.place(this.degrees);
  }

  described() {
    const { shape } = this;
    const ys = shape.curves[0].y;
    const decimals = decimalsFor(Math.max(...ys.map(Math.abs)));
    const [low, high] = [Math.min(...ys), Math.max(...ys)].map((y) => readable(y, decimals));
    return `${shape.title}: ${low} to ${high} ${shape.up.unit}, over the ${shape.right.text}`;
  }
}

function entry() {
  const item = document.createElement("span");
  item.className = "entry";
  item.append(document.createElement("i"), document.createElement("span"));
  item.append(document.createElement("b"));
  return item;
}

function isDiagram(shape) {
  return shape.right.text !== "crank angle";
}

function styleOf({ name }, n) {
  return n === 0 ? "simulated" : name === "lecture" ? "lecture" : "exact";
}

function nameOf({ up, right }) {
  return right.text === "crank angle" ? up.unit : `${up.text} [${up.unit}]`;
}

/** The value of a curve at an angle, between its points. */
function between({ x, y }, degrees) {
  const n = x.length - 1;
  const place = ((degrees - x[0]) / (x[n] - x[0])) * n;
  const k = Math.min(Math.max(Math.floor(place), 0), n - 1);
  return y[k] + (y[k + 1] - y[k]) * (place - k);
}
