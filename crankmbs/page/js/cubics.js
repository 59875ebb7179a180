/** Functions that are a cubic between every two of their knots: periodic ones of an angle, and the
 * rows of a table joined to such a one.
 *
 * A cycle is { knots, coefficients }: knots (n + 1) [rad], the last one period above the first;
 * coefficients (4 x n), by descending power of the angle behind the knot.
 */
import { countUpTo, repeated, wrapped } from "./arrays.js";

const AROUND = 60; // rows beside those of a period
const NEAR = 1e-9; // rad: an angle this close below a knot counts as on it

/** Value of a cycle at an angle [rad]; on a jump that after it. */
export function valueAt(cycle, angle) {
  const { knots, coefficients } = cycle;
  const n = knots.length - 1;
  const first = knots[0];
  const period = knots[n] - first;
  const ahead = wrapped(angle - first + NEAR, period);
  // rows are mostly about even: look near the place that even ones have
  const low = Math.max(Math.floor((ahead / period) * n) - 1, 1);
  const high = Math.min(low + 3, n);
  const near = knots[low - 1] <= ahead + first && ahead + first < knots[high];
  const k = countUpTo(knots, ahead + first, near ? low : 1, near ? high : n) - 1;
  const x = ahead - NEAR - (knots[k] - first);
  const cubic = (coefficients[k] * x + coefficients[n + k]) * x + coefficients[2 * n + k];
  return cubic * x + coefficients[3 * n + k];
}

/** The knots of a cycle, shifted by an angle and repeated over a period, from 0 to it [rad]. */
export function knotsOver({ knots }, shift, period) {
  return repeated(knots.slice(1).map((each) => each - shift), period, knots.at(-1) - knots[0]);
}

/** Rows over exactly one period joined to a cycle.
 *
 * angle [rad], value : the first value is that after the ends of the period, the last that before
 * them; a repeated angle inside is a jump. jumps : whether it jumps where the period ends.
 * interpolation : "step", "linear", "pchip" or "cubic", from jump to jump, without any periodic
 */
export function joined(rows, interpolation) {
  const { angle, value } = rows.jumps ? rows : beginningAtJump(rows);
  const cuts = [];
  for (let k = 1; k < angle.length; k++) if (angle[k] === angle[k - 1]) cuts.push(k);
  if (!rows.jumps && angle === rows.angle && cuts.length === 0) {
    return cycleOf(angle, [periodicCubics(angle, value, interpolation)]);
  }
  const ends = [0, ...cuts, angle.length];
  const knots = [];
  const pieces = [];
  for (let k = 0; k + 1 < ends.length; k++) {
    const x = angle.slice(ends[k], ends[k + 1]);
    pieces.push(openCubics(x, value.slice(ends[k], ends[k + 1]), interpolation));
    knots.push(...x.slice(0, -1));
  }
  return cycleOf([...knots, angle[angle.length - 1]], pieces);
}

/** The rows from a jump on, if there is one inside: no stretch then runs across the ends. */
function beginningAtJump(rows) {
  const { angle, value } = rows;
  const last = angle.length - 1;
  const cut = angle.findIndex((each, k) => k > 0 && each === angle[k - 1]);
  if (cut < 0) return rows;
  const period = angle[last] - angle[0];
  const turned = Array.from(angle.slice(0, cut), (each) => each + period);
  return {
    angle: Float64Array.from([...angle.slice(cut, last), ...turned]),
    value: Float64Array.from([...value.slice(cut, last), ...value.slice(0, cut)]),
  };
}

function cycleOf(knots, pieces) {
  const coefficients = new Float64Array(4 * (knots.length - 1));
  let count = 0;
  for (let power = 0; power < 4; power++) {
    for (const cubics of pieces) {
      coefficients.set(cubics[power], count);
      count += cubics[power].length;
    }
  }
  return { knots: new Float64Array(knots), coefficients };
}

/** Cubics by descending power from values and slopes at both ends of every piece (Hermite). */
function hermite(x, y, slope) {
  const [width, rise] = stepsOf(x, y);
  const cubics = [0, 1, 2, 3].map(() => new Float64Array(width.length));
  for (let k = 0; k < width.length; k++) {
    const bend = (slope[k] + slope[k + 1] - 2 * rise[k]) / width[k];
    cubics[0][k] = bend / width[k];
    cubics[1][k] = (rise[k] - slope[k]) / width[k] - bend;
    cubics[2][k] = slope[k];
    cubics[3][k] = y[k];
  }
  return cubics;
}

function openCubics(x, y, interpolation) {
  const slopes = { cubic: splineSlopes, pchip: pchipSlopes }[interpolation];
  const bends = slopes && x.length > 2;
  return bends ? hermite(x, y, slopes(x, y)) : straight(x, y, interpolation);
}

/** Rows repeated on either side make what the slopes at their ends are irrelevant: a slope takes of
 * one so many rows away at most a factor 2 ** -60. */
function periodicCubics(x, y, interpolation) {
  const n = x.length - 1;
  const period = x[n] - x[0];
  const count = n + 1 + 2 * AROUND;
  const [angle, value] = [new Float64Array(count), new Float64Array(count)];
  for (let k = 0; k < count; k++) {
    const turn = Math.floor((k - AROUND) / n);
    const row = k - AROUND - turn * n;
    angle[k] = x[row] + turn * period;
    value[k] = y[row];
  }
  const cubics = openCubics(angle, value, interpolation);
  return cubics.map((each) => each.slice(AROUND, AROUND + n));
}

function straight(x, y, interpolation) {
  const [, rise] = stepsOf(x, y);
  const none = rise.map(() => 0);
  return [none, none, interpolation === "step" ? none : rise, y.slice(0, -1)];
}

/** Widths of the intervals between rows, and the slopes of straight lines across them. */
function stepsOf(x, y) {
  const [width, rise] = [new Float64Array(x.length - 1), new Float64Array(x.length - 1)];
  for (let k = 0; k < width.length; k++) {
    width[k] = x[k + 1] - x[k];
    rise[k] = (y[k + 1] - y[k]) / width[k];
  }
  return [width, rise];
}

/** Slopes that keep monotone stretches monotone (Fritsch and Butland's harmonic mean). */
function pchipSlopes(x, y) {
  const n = x.length;
  const [width, rise] = stepsOf(x, y);
  const slope = new Float64Array(n);
  for (let k = 1; k + 1 < n; k++) {
    if (rise[k - 1] * rise[k] <= 0) continue;
    const before = 2 * width[k] + width[k - 1];
    const after = width[k] + 2 * width[k - 1];
    slope[k] = (before + after) / (before / rise[k - 1] + after / rise[k]);
  }
  slope[0] = endSlope(width[0], width[1], rise[0], rise[1]);
  slope[n - 1] = endSlope(width[n - 2], width[n - 3], rise[n - 2], rise[n - 3]);
  return slope;
}

/** Slope at an end of the parabola through three rows. */
function threePoint(near, next, rise, riseNext) {
  return ((2 * near + next) * rise - near * riseNext) / (near + next);
}

/** The same, kept from overshooting. */
function endSlope(near, next, rise, riseNext) {
  const slope = threePoint(near, next, rise, riseNext);
  if (Math.sign(slope) !== Math.sign(rise)) return 0;
  const turns = Math.sign(rise) !== Math.sign(riseNext);
  return turns && Math.abs(slope) > 3 * Math.abs(rise) ? 3 * rise : slope;
}

/** Slopes of the twice differentiable spline with the third derivative continuous at the second
 * row from either end ("not a knot"); the parabola through three rows. */
function splineSlopes(x, y) {
  const n = x.length;
  const [width, rise] = stepsOf(x, y);
  if (n === 3) return parabolaSlopes(width, rise);
  const last = n - 1;
  const [diagonal, lower, upper, right] = [0, 1, 2, 3].map(() => new Float64Array(n));
  diagonal[0] = width[1];
  upper[0] = width[0] + width[1];
  right[0] = notAKnot(width[0], width[1], rise[0], rise[1]);
  for (let k = 1; k < last; k++) {
    lower[k] = width[k];
    diagonal[k] = 2 * (width[k - 1] + width[k]);
    upper[k] = width[k - 1];
    right[k] = 3 * (width[k] * rise[k - 1] + width[k - 1] * rise[k]);
  }
  diagonal[last] = width[last - 2];
  lower[last] = width[last - 1] + width[last - 2];
  right[last] = notAKnot(width[last - 1], width[last - 2], rise[last - 1], rise[last - 2]);
  return tridiagonal(lower, diagonal, upper, right);
}

function notAKnot(near, next, rise, riseNext) {
  const both = near + next;
  return ((near + 2 * both) * next * rise + near * near * riseNext) / both;
}

/** Slopes of the parabola through three rows. */
function parabolaSlopes([near, far], [first, last]) {
  const middle = (far * first + near * last) / (near + far);
  return [threePoint(near, far, first, last), middle, threePoint(far, near, last, first)];
}

/** Solve a tridiagonal system; the end rows of a spline may have a small diagonal, and are mild. */
function tridiagonal(lower, diagonal, upper, right) {
  const n = diagonal.length;
  const [pivot, answer] = [new Float64Array(n), new Float64Array(n)];
  pivot[0] = diagonal[0];
  answer[0] = right[0];
  for (let k = 1; k < n; k++) {
    const factor = lower[k] / pivot[k - 1];
    pivot[k] = diagonal[k] - factor * upper[k - 1];
    answer[k] = right[k] - factor * answer[k - 1];
  }
  answer[n - 1] /= pivot[n - 1];
  for (let k = n - 2; k >= 0; k--) answer[k] = (answer[k] - upper[k] * answer[k + 1]) / pivot[k];
  return answer;
}
