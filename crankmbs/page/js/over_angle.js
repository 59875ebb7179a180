/** A prescribed speed that is known over the crank angle: t = int d theta / omega, and back.
 *
 * omega is a cubic between knots [rad]; the integral is Gauss quadrature on panels so narrow that
 * it is exact but for rounding. Knots, panels { begin, width, lead, piece, times } and the rule
 * come from Python; lead [rad] : how far a panel begins behind the knot of its piece.
 */
import { countUpTo, rootOf } from "./arrays.js";

export class OverAngle {
  constructor(law) {
    Object.assign(this, law);
    const n = law.knots.length - 1;
    this.sense = law.coefficients[3 * n] < 0 ? -1 : 1;
    this.period = law.knots[n] - law.knots[0];
    this.elapsed = [0];
    for (const each of law.times) this.elapsed.push(this.elapsed[this.elapsed.length - 1] + each);
    this.begun = this.slowly(law.angle);
  }

  /** Crank angle, speed and acceleration at a time [s]; beyond the rows it goes on as it was. */
  at(time) {
    const { sense, elapsed, begin, repeats, period } = this;
    const whole = elapsed[elapsed.length - 1];
    const aim = sense * time + this.begun;
    const turns = repeats ? Math.floor(aim / whole) : 0;
    const inside = Math.min(Math.max(aim - turns * whole, 0), whole);
    const k = Math.min(countUpTo(elapsed, inside) - 1, begin.length - 1);
    const x = this.reached(k, inside - elapsed[k]);
    const [omega, slope] = this.speedIn(k, x);
    const beyond = (aim - turns * whole - inside) * Math.abs(omega);
    return [begin[k] + x + turns * period + beyond, omega, slope * omega];
  }

  timeAt(theta) {
    return this.sense * (this.slowly(theta) - this.begun);
  }

  /** Crank angles between two others at which it bends. */
  bendsBetween(low, high) {
    const { knots, repeats, period } = this;
    const turnOf = (theta) => (repeats ? Math.floor((theta - knots[0]) / period) : 0);
    const found = [];
    for (let turn = turnOf(low); turn <= turnOf(high); turn++) {
      for (const knot of knots) found.push(knot + turn * period);
    }
    return found.filter((each) => each > low && each < high);
  }

  /** int d theta / |omega| from the first knot on [s]. */
  slowly(theta) {
    const { knots, period, begin, elapsed, repeats } = this;
    const ahead = theta - knots[0];
    const turns = repeats ? Math.floor(ahead / period) : 0;
    const inside = Math.min(Math.max(ahead - turns * period, 0), period);
    const k = Math.min(Math.max(countUpTo(begin, inside + knots[0]) - 1, 0), begin.length - 1);
    const x = inside - (begin[k] - knots[0]);
    return turns * elapsed[elapsed.length - 1] + elapsed[k] + this.within(k, x);
  }

  /** The same over the first x [rad] of panel k. */
  within(k, x) {
    const { nodes, weights } = this;
    let sum = 0;
    for (let j = 0; j < nodes.length; j++) {
      sum += weights[j] / Math.abs(this.speedIn(k, x * nodes[j])[0]);
    }
    return x * sum;
  }

  /** How far into panel k [rad] the crank is after a time [s]. */
  reached(k, time) {
    const whole = this.width[k];
    const f = (x) => [this.within(k, x) - time, 1 / Math.abs(this.speedIn(k, x)[0])];
    const start = Math.min(time * Math.abs(this.speedIn(k, 0)[0]), whole);
    return rootOf(f, [0, whole], start, () => 4e-16 * whole);
  }

  /** Speed and its slope over the angle, x [rad] into panel k. */
  speedIn(k, x) {
    const { coefficients, piece, lead, knots } = this;
    const n = knots.length - 1;
    const behind = lead[k] + x;
    const [a, b] = [coefficients[piece[k]], coefficients[n + piece[k]]];
    const [c, d] = [coefficients[2 * n + piece[k]], coefficients[3 * n + piece[k]]];
    const omega = ((a * behind + b) * behind + c) * behind + d;
    return [omega, (3 * a * behind + 2 * b) * behind + c];
  }
}
