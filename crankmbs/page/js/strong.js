/** The knots at which a cycle jumps, or bends so sharply that a screen would show it.
 *
 * Cells of a quick pass go over all others, of which a table with a row a degree has hundreds.
 */
import { once } from "./arrays.js";

const BEND = 0.1; // rad: as wide as a cell
const STRONG = 0.02; // of the range of a cycle

/** Cycles of the same periods with their strong knots alone, or one; what was one stays one. */
export function strongOf(cycles) {
  return cycles.map(once(atStrongKnots));
}

function atStrongKnots({ knots, coefficients }) {
  const n = knots.length - 1;
  const values = coefficients.subarray(3 * n);
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const strong = [];
  for (let k = 0, before = n - 1; k < n; before = k++) {
    const x = knots[before + 1] - knots[before];
    const a = coefficients[before] * x;
    const b = coefficients[n + before];
    const c = coefficients[2 * n + before];
    const jump = coefficients[3 * n + k] - (((a + b) * x + c) * x + coefficients[3 * n + before]);
    const bend = coefficients[2 * n + k] - ((3 * a + 2 * b) * x + c);
    const seen = Math.abs(jump) + BEND * Math.abs(bend);
    if (seen > STRONG * (high - low)) strong.push(knots[k]);
  }
  if (strong.length === 0) strong.push(0);
  return { knots: Float64Array.from([...strong, strong[0] + knots[n] - knots[0]]) };
}
