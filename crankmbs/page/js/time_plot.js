/** The crank speed over a run, whole or page by page, with its events and, where it varies, the
 * fuel; the cursor can be dragged. */
import { drawAxes, frameOf, valueUnder } from "./axis.js";
import { RPM, readable } from "./format.js";
import { rangeOf, spread } from "./shapes.js";
import { slid } from "./slide.js";
import { Pen, add, lineOf, set, watched } from "./svg.js";

const LETTER = 0.55; // of the type: how wide a letter is
const LINE = 1.2; // of the type: a row of words
const STRIP = 0.24; // of the height, for the fuel
const HEAD = 0.5; // of the speed's axis, at most kept free for words
const POINTS = 300; // of a page's curve, besides the frames

export class TimePlot {
  /** root : a figure with an svg; given : { time, speed, marks, fuel } of a run, its marks each
   * { time [s], words }; on : { speedAt(time) [rpm], move(time that is asked for) } */
  constructor(root, { time, speed, marks, fuel }, on) {
    Object.assign(this, { marks, fuel, on, frame: null, strip: null, at: null, size: null });
    [this.pages, this.page] = [1, 0];
    this.held = false; // the page stays while it is
    this.svg = root.querySelector("svg");
    root.classList.toggle("strip", fuel !== null);
    this.curve = { x: Array.from(time), y: Array.from(speed, (each) => each / RPM) };
    this.axes = [add(this.svg, "g"), add(this.svg, "g")];
    this.events = add(this.svg, "g", { class: "events" });
    const lines = add(this.svg, "g", { transform: "scale(0.1)" });
    this.line = add(lines, "path", { class: "curve simulated" });
    this.steps = add(lines, "path", { class: "curve fuel" });
    this.cursor = add(this.svg, "g", { class: "cursor" });
    watched(this.svg, (size) => {
      this.size = size;
      this.draw();
    });
    slid(this.svg, {
      press: ({ isPrimary, button }) => (this.held = this.frame && isPrimary && button === 0),
      move: (event) => this.on.move(valueUnder(event, this.svg, this.frame)),
      release: () => {
        this.held = false;
        this.place(...this.at);
      },
    });
  }

  /** Show the run in so many pages, of which that of the cursor is seen. */
  divide(pages) {
    this.pages = pages;
    this.page = this.at ? this.pageOf(this.at[0]) : 0;
    this.draw();
  }

  /** The page of a time [s]. */
  pageOf(time) {
    const { x } = this.curve;
    const part = (time - x[0]) / (x[x.length - 1] - x[0]);
    return Math.min(Math.floor(part * this.pages), this.pages - 1);
  }

  /** What the page has of the curve, and its marks. */
  seen() {
    const { curve, marks, page, pages, on } = this;
    if (pages === 1) return { curve, marks };
    const [begin, end] = [curve.x[0], curve.x[curve.x.length - 1]];
    const [low, high] = [0, 1].map((n) => begin + ((end - begin) * (page + n)) / pages);
    const within = (time) => time >= low && time <= high;
    const x = [...curve.x.filter(within), ...spread(low, high, POINTS)].sort((a, b) => a - b);
    return { curve: { x, y: x.map(on.speedAt) }, marks: marks.filter(({ time }) => within(time)) };
  }

  draw() {
    const { width, height, type } = this.size ?? { width: 0 };
    if (width < 50 || height < 50) return;
    const { curve, marks } = this.seen();
    const fuel = this.fuel && stepsOf(this.fuel, curve.x[0], curve.x[curve.x.length - 1]);
    set(this.svg, { viewBox: `0 0 ${width} ${height}`, "aria-label": this.described() });
    const foot = height - 2.6 * type;
    const box = { left: 4.4 * type, right: width - 1.7 * type, top: 1.3 * type, bottom: foot };
    const below = { ...box, top: foot - STRIP * height };
    if (fuel) box.bottom = below.top - 1.7 * type;
    const labels = labelsOf(marks, curve, box, type);
    const rows = Math.max(0, ...labels.map(({ row }) => row + 1));
    const share = Math.min((LINE * type * rows) / (box.bottom - box.top), HEAD);
    const [low, high] = rangeOf([curve.y]);
    const holds = { y: [high + (share / (1 - share)) * (high - low)] };
    const shape = { curves: [curve], right: { text: "time", unit: "s" } };
    const about = { type, shape, overAngle: false, left: box.left };
    this.frame = frameOf(box, [curve], { shape, overAngle: true, holds });
    drawAxes(this.axes[0], this.frame, { ...about, last: !fuel, name: "crank speed [rpm]" });
    set(this.line, { d: lineOf(curve, this.frame) });
    if (fuel) {
      this.strip = frameOf(below, [fuel], { shape, overAngle: true, holds: { y: [0] } });
      drawAxes(this.axes[1], this.strip, { ...about, last: true, name: "share of the fuel" });
      set(this.steps, { d: lineOf(fuel, this.strip) });
    }
    Object.assign(this, { type, foot });
    this.drawEvents(marks, labels);
    if (this.at) this.place(...this.at);
  }

  drawEvents(marks, labels) {
    const { right, box } = this.frame;
    const pen = new Pen(this.events);
    const below = this.strip ? [this.strip.box] : [];
    for (const { time } of marks) {
      for (const { top, bottom } of [box, ...below]) {
        pen.add("line", { x1: right(time), x2: right(time), y1: top, y2: bottom });
      }
    }
    for (const { words, place } of labels) pen.add("text", place, words);
    pen.end();
  }

  /** Put the cursor at a time [s] and speed [rpm]. */
  place(time, speed) {
    this.at = [time, speed];
    if (!this.frame) return;
    const page = this.held ? this.page : this.pageOf(time);
    if (page !== this.page) {
      this.page = page;
      this.draw(); // and places the cursor
      return;
    }
    const { right, up, box } = this.frame;
    const pen = new Pen(this.cursor);
    const x = right(time);
    pen.add("line", { x1: x, x2: x, y1: box.top, y2: this.foot });
    pen.add("circle", { cx: x, cy: up(speed), r: 0.3 * this.type });
    pen.end();
  }

  described() {
    const { curve: { y }, marks } = this;
    const [low, high] = rangeOf([y]).map((each) => readable(each, 0));
    const events = marks.map(({ time, words }) => `${words} at ${readable(time, 3)} s`);
    return [`crank speed over time: ${low} to ${high} rpm`, ...events].join(", ");
  }
}

/** The line of shares between two times, each from when it is decided to the next. */
function stepsOf({ time, share }, low, high) {
  const [x, y] = [[], []];
  time.forEach((each, k) => {
    const [from, to] = [Math.max(each, low), Math.min(time[k + 1] ?? high, high)];
    if (from >= to) return;
    x.push(from, to);
    y.push(share[k], share[k]);
  });
  return { x, y };
}

/** The words of events, each once where several stand close, each in the highest row in which
 * nothing is under it. */
function labelsOf(marks, { x }, box, type) {
  const scale = (box.right - box.left) / (x[x.length - 1] - x[0]);
  const found = [];
  for (const { time, words } of marks) {
    const at = box.left + (time - x[0]) * scale;
    const wide = LETTER * type * words.length + 0.6 * type;
    const flip = at + wide > box.right;
    const [from, to] = flip ? [at - wide, at] : [at, at + wide];
    const near = found.filter((each) => each.from < to && from < each.to);
    if (near.some((each) => each.words === words)) continue;
    const free = (row) => near.every((each) => each.row !== row);
    let row = 0;
    while (!free(row)) row++;
    const place = { x: at + (flip ? -0.3 : 0.3) * type, y: box.top + (row + 0.9) * LINE * type };
    found.push({ words, from, to, row, place: { ...place, class: flip ? "end" : "name" } });
  }
  return found;
}
