/** Friction of the pistons on their walls, { ring_force, ring_pressure, viscous } or null:
 *
 *     friction_force = -sign(v) (ring_force + ring_pressure |gas_force|) - viscous v
 *
 * with the piston's velocity v = -x1 omega. On the crank it is, with the torque of each cylinder's
 * gas, -sign(omega) (ring_force sum |x1| + ring_pressure sum |gas|) - viscous omega sum x1^2: all
 * but the last is a function of the angle, smooth between dead centres and changes of the gas's
 * sign. Forces from outside that resist as these do (`applied`) are among `rings` and `drag`.
 */
import { repeated, rootIn, wrapped } from "./arrays.js";
import { deadCentres } from "./geometry.js";

const KNOT = 1e-9; // rad: at a dead centre the value after it counts
const TURN = 2 * Math.PI;

/** What rings oppose to either sense of rotation [N m], at an angle that is reduced. */
export function ringTorque(friction, { rings, gas, combustion }, shares) {
  if (friction === null || friction.ring_pressure === 0) return rings;
  let pressed = 0;
  for (let k = 0; k < gas.length; k++) {
    pressed += Math.abs(gas[k] + (shares.length ? shares[k] * combustion[k] : 0));
  }
  return rings + friction.ring_pressure * pressed;
}

/** In which sense a piston slides towards the crank, 1 or -1, at a cycle angle and a speed. */
export function slides(shape, phi, omega) {
  const { top, bottom } = deadCentres(shape);
  const sense = omega < 0 ? -1 : 1;
  const behind = wrapped(phi + sense * KNOT - top, TURN);
  return behind < bottom - top ? sense : -sense;
}

/** Friction on a piston [N], positive towards the crank, at a cycle angle of the closed loop. */
export function frictionForce(friction, shape, { phi, x1 }, omega, gasForce) {
  const towards = slides(shape, phi, omega);
  const limit = friction.ring_force + friction.ring_pressure * Math.abs(gasForce);
  return -towards * limit + friction.viscous * x1 * omega;
}

/** Crank angles of a period at which friction bends [rad]: dead centres, and where the gas on a
 * piston changes its sign; cycles : of the pressure of one cylinder after the other, and so on */
export function frictionMarks(friction, shapes, cylinders, cycles, period) {
  if (friction === null) return [];
  const found = cylinders.flatMap(({ phase }, k) => centresOver(shapes[k], phase, period));
  if (friction.ring_pressure === 0) return found;
  cycles.forEach(({ knots, coefficients }, k) => {
    const { phase } = cylinders[k % cylinders.length];
    const own = knots[knots.length - 1] - knots[0];
    const roots = signChanges(knots, coefficients);
    found.push(...repeated(roots.map((angle) => angle - phase), period, own));
  });
  return found;
}

/** Crank angles of a period at which a cylinder of a phase is at a dead centre [rad]. */
export function centresOver(shape, phase, period) {
  const { top, bottom } = deadCentres(shape);
  return repeated([top - phase, bottom - phase], period);
}

/** Where piecewise cubics change their sign between knots. */
function signChanges(knots, coefficients) {
  const n = knots.length - 1;
  const found = [];
  for (let k = 0; k < n; k++) {
    const [a, b, c, d] = [0, 1, 2, 3].map((power) => coefficients[power * n + k]);
    const value = (x) => ((a * x + b) * x + c) * x + d;
    const width = knots[k + 1] - knots[k];
    const turns = turningPoints(3 * a, 2 * b, c).filter((x) => x > 0 && x < width);
    const places = [0, ...turns.sort((x, y) => x - y), width];
    for (let j = 0; j + 1 < places.length; j++) {
      const [low, high] = [places[j], places[j + 1]];
      const side = Math.sign(value(high));
      if (value(low) * side < 0) found.push(knots[k] + rootIn((x) => side * value(x), low, high));
    }
  }
  return found;
}

/** The roots of a parabola. */
function turningPoints(a, b, c) {
  const root = Math.sqrt(b * b - 4 * a * c);
  if (!(root >= 0)) return [];
  const sum = -0.5 * (b + (b < 0 ? -root : root));
  return [sum / a, c / sum].filter(Number.isFinite);
}
