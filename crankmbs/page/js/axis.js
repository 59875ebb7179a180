/** Axes of a plot: maps of values to pixels, with grid, ticks and names. */
import { readable, roundTicks, steps } from "./format.js";
import { rangeOf } from "./shapes.js";
import { Pen, set } from "./svg.js";

const QUARTERS = [45, 90, 180, 360, 720]; // degrees between ticks of the crank angle

/** How curves { x, y } are put into a box: { box, right, up, x, y }, maps of values to pixels and
 * the ranges shown. holds : values { x, y } that the ranges hold besides, or none */
export function frameOf(box, curves, { shape, overAngle, holds = {} }) {
  let y = roundRange(curves.map((curve) => curve.y), holds.y);
  let x = overAngle
    ? ends(shape.curves[0].x)
    : roundRange(curves.map((curve) => curve.x), holds.x);
  if (shape.equal) [x, y] = squared(box, x, y);
  const [from, to] = shape.equal ? [box.right, box.left] : [box.left, box.right];
  const right = (value) => from + ((value - x.low) / (x.high - x.low)) * (to - from);
  const up = (value) =>
    box.bottom - ((value - y.low) / (y.high - y.low)) * (box.bottom - box.top);
  return { box, right, up, x, y };
}

/** The value to the right at which a pointer is, within a frame in an svg. */
export function valueUnder({ clientX }, svg, { box, x }) {
  const { left } = svg.getBoundingClientRect();
  const part = (clientX - left - box.left) / (box.right - box.left);
  return x.low + Math.min(Math.max(part, 0), 1) * (x.high - x.low);
}

/** Draw the axes of a frame into a group.
 *
 * about : { type in pixels, shape, overAngle, last whether the values to the right stand below,
 * name, left where it stands }
 */
export function drawAxes(group, { box, right, up, x, y }, about) {
  const pen = new Pen(group);
  const lines = { grid: "", zero: "", "dead top": "", "dead bottom": "" };
  const paths = Object.keys(lines).map((style) => [style, pen.add("path", { class: style })]);
  ordinate({ pen, lines }, box, up, { y, type: about.type });
  abscissa({ pen, lines }, box, right, { x, ...about });
  const at = { x: about.left, y: box.top - 0.35 * about.type, class: "name" };
  pen.add("text", at, about.name);
  pen.end();
  for (const [style, path] of paths) set(path, { d: lines[style] });
}

/** Draw marks { degrees, name } at dead centres into the axes of a frame. */
export function drawMarks(group, { box, right }, marks) {
  for (const style of ["dead top", "dead bottom"]) {
    const own = marks.filter(({ name }) => style === `dead ${name}`);
    const d = own.map(({ degrees }) => upright(box, right(degrees))).join("");
    set(group.querySelector(`[class="${style}"]`), { d });
  }
}

function ordinate({ pen, lines }, box, up, { y, type }) {
  const count = Math.max((box.bottom - box.top) / (1.3 * type), 2);
  let { ticks, step } = roundTicks(y.low, y.high, count);
  if (ticks.length < 2) { // one says nothing of the scale
    ({ ticks, step } = roundTicks(y.low, y.high, 2 * count));
    if (ticks.length > 3) ticks = ticks.filter((tick) => Math.round(tick / step) % 2 === 0);
    if (ticks.length === 3 && up(ticks[0]) - up(ticks[1]) < 0.9 * type) ticks.splice(1, 1);
  }
  for (const tick of ticks) {
    const at = up(tick);
    lines[styleOf(tick, step)] += `M${box.left} ${at}H${box.right}`;
    const place = { x: box.left - 0.4 * type, y: at + 0.35 * type, class: "tick end" };
    pen.add("text", place, readable(tick, digitsOf(step)));
  }
}

/** The crank angle, or another quantity with its name. */
function abscissa({ pen, lines }, box, right, { x, type, shape, overAngle, last }) {
  const letters = (box.right - box.left) / type;
  const { ticks, step } = overAngle
    ? quarters(x, letters / 3.6)
    : roundTicks(x.low, x.high, Math.max(letters / 5, 2));
  for (const tick of ticks) {
    lines[overAngle ? "grid" : styleOf(tick, step)] += upright(box, right(tick));
    const place = { x: right(tick), y: box.bottom + 1.25 * type, class: "tick" };
    const text = readable(tick, digitsOf(step));
    if (last) pen.add("text", place, overAngle ? `${text}°` : text);
  }
  if (overAngle || !last) return;
  const middle = { x: 0.5 * (box.left + box.right), y: box.bottom + 2.3 * type };
  const { text: name, unit } = shape.right;
  const text = unit ? `${name} [${unit}]` : name;
  pen.add("text", { ...middle, class: "name mid" }, text);
}

/** Parts of a turn, at most so many: { ticks, step }. */
function quarters({ low, high }, count) {
  const step = QUARTERS.find((each) => (high - low) / each <= count) ?? 720;
  return { step, ticks: steps(low, high, step) };
}

function upright(box, at) {
  return `M${at} ${box.top}V${box.bottom}`;
}

function styleOf(tick, step) {
  return Math.abs(tick) < 1e-9 * step ? "zero" : "grid";
}

function digitsOf(step) {
  return Math.max(-Math.floor(Math.log10(step) + 1e-9), 0);
}

function ends(x) {
  return { low: Math.min(x[0], x[x.length - 1]), high: Math.max(x[0], x[x.length - 1]) };
}

/** A range around values, which does not change with every little change of them; it begins at a 0
 * that it is to hold. */
function roundRange(lists, holds = []) {
  let [low, high] = rangeOf([...lists, holds]);
  if (low > high) [low, high] = [-1, 1];
  const most = Math.max(Math.abs(low), Math.abs(high));
  const size = most > 1e-12 ? most : 1; // at rest, an axis about 0 that can be read
  if (!(high - low > 1e-9 * size)) [low, high] = [low - 0.01 * size, high + 0.01 * size];
  const room = 0.03 * (high - low);
  const { step } = roundTicks(low, high, 24);
  return {
    low: low === 0 && holds.includes(0) ? 0 : Math.floor((low - room) / step) * step,
    high: Math.ceil((high + room) / step) * step,
  };
}

/** The ranges with which both axes have one scale: that which has room to spare is widened. */
function squared(box, x, y) {
  const [wide, high] = [box.right - box.left, box.bottom - box.top];
  const scale = Math.min(wide / (x.high - x.low), high / (y.high - y.low));
  return [widened(x, wide / scale), widened(y, high / scale)];
}

function widened({ low, high }, size) {
  const middle = 0.5 * (low + high);
  return { low: middle - 0.5 * size, high: middle + 0.5 * size };
}
