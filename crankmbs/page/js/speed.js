/** Prescribed speeds that do not reverse: crank angle, speed and acceleration over time, and back.
 *
 * A law is { kind: "polynomial", knots, coefficients, angle }, omega(t) of cubics between times of
 * which the last may be infinite; or { kind: "oscillation", mean, amplitude, order, phase, angle },
 * omega = mean + amplitude cos(order theta + phase); or one "over_angle".
 */
import { countUpTo, recurring, rootOf } from "./arrays.js";

/** The law as an object with `at(time)` -> [theta, omega, alpha], `timeAt(theta)` and the crank
 * angles at which it bends, `bendsBetween(from, to)`, and others beside. */
export function speedLaw(law) {
  if (law.kind === "over_angle") return new OverAngle(law);
  return law.kind === "oscillation" ? new Oscillation(law) : new Polynomial(law);
}

class Polynomial {
  constructor({ knots, coefficients, angle }) {
    this.knots = knots;
    const n = knots.length - 1;
    this.cubics = Array.from({ length: n }, (_, k) =>
      [0, 1, 2, 3].map((power) => coefficients[power * n + k]));
    this.angles = [angle];
    for (let k = 0; k + 1 < n; k++) {
      this.angles.push(this.angles[k] + turned(this.cubics[k], knots[k + 1] - knots[k]));
    }
    const before = this.at(0)[0] - angle;
    this.angles = this.angles.map((each) => each - before);
  }

  at(time) {
    const { knots, cubics, angles } = this;
    const k = Math.max(countUpTo(knots, time, 1, knots.length - 1) - 1, 0);
    const x = time - knots[k];
    const [a, b, c, d] = cubics[k];
    const omega = ((a * x + b) * x + c) * x + d;
    return [angles[k] + turned(cubics[k], x), omega, (3 * a * x + 2 * b) * x + c];
  }

  timeAt(theta) {
    const { knots, cubics, angles } = this;
    const sense = this.at(0)[1] < 0 ? -1 : 1;
    const k = Math.max(countUpTo(angles.map((each) => sense * each), sense * theta) - 1, 0);
    const whole = knots[k + 1] - knots[k];
    const even = Math.abs((theta - angles[k]) / cubics[k][3]); // in an endless piece
    const high = Number.isFinite(whole) ? whole : 2 * (even + 1e-9);
    const f = (x) => [angles[k] + turned(cubics[k], x) - theta, this.at(knots[k] + x)[1]]
      .map((each) => sense * each);
    const hair = (x) => 4e-16 * (knots[k] + x);
    return knots[k] + rootOf(f, [0, high], 0.5 * high, hair);
  }

  bendsBetween() {
    return Array.from(this.knots).slice(1).filter(Number.isFinite).map((time) => this.at(time)[0]);
  }
}

/** Angle turned after x [s] under a cubic of the speed [rad]. */
function turned([a, b, c, d], x) {
  return ((((a / 4) * x + b / 3) * x + c / 2) * x + d) * x;
}

/** With psi = n theta + phase the angle u(psi) = 2 atan(kappa tan(psi / 2)), where kappa^2 =
 * (m - A) / (m + A), grows evenly in time: u' = n sqrt(m^2 - A^2). */
class Oscillation {
  constructor(law) {
    const { mean: m, amplitude: a, order } = law;
    Object.assign(this, law);
    this.kappa = Math.sqrt((m - a) / (m + a));
    this.rate = Math.sign(m) * order * Math.sqrt((m - a) * (m + a));
    this.begin = this.even(order * law.angle + law.phase);
  }

  at(time) {
    const u = this.begin + this.rate * time;
    const psi = u + bend(u, 1 / this.kappa);
    const omega = this.mean + this.amplitude * Math.cos(psi);
    const alpha = -this.amplitude * this.order * Math.sin(psi) * omega;
    return [(psi - this.phase) / this.order, omega, alpha];
  }

  timeAt(theta) {
    return (this.even(this.order * theta + this.phase) - this.begin) / this.rate;
  }

  bendsBetween() {
    return [];
  }

  even(psi) {
    return psi + bend(psi, this.kappa);
  }
}

/** 2 atan(kappa tan(angle / 2)) - angle, without a branch cut. */
function bend(angle, kappa) {
  const [s, c] = [Math.sin(0.5 * angle), Math.cos(0.5 * angle)];
  return 2 * Math.atan2((kappa - 1) * s * c, c * c + kappa * s * s);
}

/** Known over the crank angle: t = int d theta / omega, and back.
 *
 * omega is a cubic between knots [rad]; the integral is Gauss quadrature on panels so narrow that
 * it is exact but for rounding. Knots, panels { begin, width, lead, piece, times } and the rule
 * come from Python; lead [rad] : how far a panel begins behind the knot of its piece. */
class OverAngle {
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

  /** Crank angles at which it bends; where they come again, from one to another. */
  bendsBetween(from, to) {
    const { knots, repeats, period } = this;
    return repeats ? recurring(knots.slice(1), period, from, to) : knots;
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
