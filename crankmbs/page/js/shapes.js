/** What the plots of lessons draw: shapes as `quantities.drawn` gives them. */
import { DEGREE } from "./format.js";

/** Curves over the crank angle, each { name, style, of(variables) } in `unit`, or with values y at
 * the samples in place of `of`; of : its value at a crank angle [rad], where the first has those.
 *
 * apart : [name, n, m] of differences of curves that stand below; holds, holdsBelow : values in the
 * range of the axes
 */
export function overAngle(cycle, { title, unit, curves, apart = [], ...about }) {
  const x = cycle.angles.map((theta) => theta / DEGREE);
  const drawn = curves.map(({ name, style, of, y }) =>
    ({ name, style, x, y: y ?? cycle.samples.map(of) }));
  const differences = apart.map(([name, n, m]) => ({
    name, x, y: drawn[n].y.map((value, i) => value - drawn[m].y[i]),
  }));
  return {
    title,
    up: { text: title, unit },
    right: { text: "crank angle", unit: "°" },
    curves: drawn,
    differences,
    of: (theta) => curves[0].of(cycle.at(theta)),
    ...about,
  };
}

/** Curves { name, style, x, y } of one quantity over another, each axis { text, unit }; of : where
 * the dot stands at a crank angle [rad], [x, y] */
export function diagram({ title, right, up, curves, of, ...about }) {
  return { title, right, up, curves, differences: [], of, ...about };
}

/** The least and the greatest of lists of values, of which gaps are NaN; [Infinity, -Infinity] of
 * none. */
export function rangeOf(lists) {
  let [low, high] = [Infinity, -Infinity];
  for (const values of lists) {
    for (let k = 0; k < values.length; k++) {
      if (values[k] < low) low = values[k];
      if (values[k] > high) high = values[k];
    }
  }
  return [low, high];
}

/** The largest size of some values in lists. */
export function sizeOf(lists) {
  const [low, high] = rangeOf(lists);
  return Math.max(high, -low, 0);
}

/** The rod ratio of a cycle's first cylinder. */
export function ratioOf({ train: { shape } }) {
  return shape.radius / shape.length;
}

/** The value of even steps at a part of their way, on the line between the steps beside it. */
export function valueAlong(values, part) {
  const place = part * (values.length - 1);
  const k = Math.min(Math.max(Math.floor(place), 0), values.length - 2);
  return values[k] + (values[k + 1] - values[k]) * (place - k);
}

/** So many values from one to another. */
export function spread(low, high, count) {
  return Array.from({ length: count + 1 }, (_, k) => low + ((high - low) * k) / count);
}
