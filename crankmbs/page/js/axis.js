/** Axes of a plot: maps of values to pixels, with grid, ticks and names. */
import { readable, roundTicks } from "./format.js";
import { add } from "./svg.js";

const QUARTERS = [45, 90, 180, 360, 720]; // degrees between ticks of the crank angle

/** How curves { x, y } are put into a box: { box, right, up, x, y }, maps of values to pixels and
 * the ranges shown. holds : values { x, y } that the ranges hold besides, or none */
export function frameOf(box, curves, { shape, overAngle, holds = {} }) {
  const y = rangeOf([...curves.flatMap((curve) => curve.y), ...(holds.y ?? [])]);
  const across = () => [...curves.flatMap((curve) => curve.x), ...(holds.x ?? [])];
  const x = overAngle ? ends(shape.curves[0].x) : rangeOf(across());
  const bounds = shape.equal ? squared(box, x, y) : box;
  const [from, to] = shape.equal ? [bounds.right, bounds.left] : [bounds.left, bounds.right];
  const right = (value) => from + ((value - x.low) / (x.high - x.low)) * (to - from);
  const up = (value) =>
    bounds.bottom - ((value - y.low) / (y.high - y.low)) * (bounds.bottom - bounds.top);
  return { box: bounds, right, up, x, y };
}

/** Draw the axes of a frame into a group.
 *
 * about : { type in pixels, shape, marks at dead centres, overAngle, last whether the angles stand
 * below, name, left where it stands }
 */
export function drawAxes(group, { box, right, up, x, y }, about) {
  group.replaceChildren();
  ordinate(group, box, up, { y, type: about.type });
  if (about.overAngle) angles(group, box, right, { x, ...about });
  else abscissa(group, box, right, { x, ...about });
  const at = { x: about.left, y: box.top - 0.35 * about.type, class: "name" };
  add(group, "text", at, about.name);
}

function ordinate(group, box, up, { y, type }) {
  const count = Math.max((box.bottom - box.top) / (1.3 * type), 2);
  const { ticks, step } = roundTicks(y.low, y.high, count);
  for (const tick of ticks) {
    const at = up(tick);
    const style = Math.abs(tick) < 1e-9 * step ? "zero" : "grid";
    add(group, "line", { x1: box.left, x2: box.right, y1: at, y2: at, class: style });
    const place = { x: box.left - 0.4 * type, y: at + 0.35 * type, class: "tick end" };
    add(group, "text", place, readable(tick, digitsOf(step)));
  }
}

/** The crank angle, with the dead centres. */
function angles(group, box, right, { x, type, marks, last }) {
  const wide = (box.right - box.left) / (3.6 * type);
  const step = QUARTERS.find((each) => (x.high - x.low) / each <= wide) ?? 720;
  for (let k = Math.ceil(x.low / step - 1e-9); k * step <= x.high + 1e-6; k++) {
    upright(group, box, right(k * step), "grid");
    const place = { x: right(k * step), y: box.bottom + 1.15 * type, class: "tick" };
    if (last) add(group, "text", place, `${readable(k * step, 0)}°`);
  }
  for (const { degrees, name } of marks) {
    upright(group, box, right(degrees), `dead ${name}`);
  }
}

/** Another quantity to the right. */
function abscissa(group, box, right, { x, type, shape }) {
  const count = Math.max((box.right - box.left) / (5 * type), 2);
  const { ticks, step } = roundTicks(x.low, x.high, count);
  for (const tick of ticks) {
    upright(group, box, right(tick), Math.abs(tick) < 1e-9 * step ? "zero" : "grid");
    const place = { x: right(tick), y: box.bottom + 1.15 * type, class: "tick" };
    add(group, "text", place, readable(tick, digitsOf(step)));
  }
  const middle = { x: 0.5 * (box.left + box.right), y: box.bottom + 2.3 * type };
  const { text: name, unit } = shape.right;
  const text = unit ? `${name} [${unit}]` : name;
  add(group, "text", { ...middle, class: "name mid" }, text);
}

function upright(group, box, at, style) {
  add(group, "line", { x1: at, x2: at, y1: box.top, y2: box.bottom, class: style });
}

function digitsOf(step) {
  return Math.max(-Math.floor(Math.log10(step) + 1e-9), 0);
}

function ends(x) {
  return { low: Math.min(x[0], x[x.length - 1]), high: Math.max(x[0], x[x.length - 1]) };
}

/** A range around values, which does not change with every little change of them. */
function rangeOf(values) {
  let low = Math.min(...values);
  let high = Math.max(...values);
  if (!values.length) [low, high] = [-1, 1];
  const size = Math.max(Math.abs(low), Math.abs(high), 1e-12);
  if (!(high - low > 1e-9 * size)) [low, high] = [low - 0.01 * size, high + 0.01 * size];
  const room = 0.03 * (high - low);
  const { step } = roundTicks(low, high, 24);
  return {
    low: Math.floor((low - room) / step) * step,
    high: Math.ceil((high + room) / step) * step,
  };
}

/** The part of a box in which both axes have one scale. */
function squared(box, x, y) {
  const [wide, high] = [x.high - x.low, y.high - y.low];
  const scale = Math.min((box.right - box.left) / wide, (box.bottom - box.top) / high);
  const middle = 0.5 * (box.left + box.right);
  const half = 0.5 * scale * wide;
  return { ...box, left: middle - half, right: middle + half, top: box.bottom - scale * high };
}
