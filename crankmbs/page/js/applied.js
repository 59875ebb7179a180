/** Forces from outside on the pistons along their axes, positive towards the crank.
 *
 * A force comes from Python as what it is the sum of: { cylinder, forward, back, over_angle,
 * viscous }. forward and back are straight lines between knots over the piston's displacement, as
 * it moves towards the crank and away from it, back null where both are the same; over_angle is a
 * cycle over its cycle angle; viscous the force per speed, against it. Then
 *
 *     F = steady - sign(v) jumping - viscous v,    jumping = (F_back - F_forward) / 2,
 *
 * with the piston's velocity v = -x1 omega. The crank feels -x1 F: of the angle alone, but for
 * jumping, which resists as rings do, and viscous, which is a drag.
 */
import { countUpTo, repeated } from "./arrays.js";
import { knotsOver, valueAt } from "./cubics.js";
import { centresOver, slides } from "./friction.js";
import { strokeOf, throwAngles } from "./geometry.js";
import { strongOf } from "./strong.js";

const KNOT = 1e-9; // rad: on a jump the force is that after it
const NONE = { steady: 0, jumping: 0 };

/** Those that act on the piston of cylinder k, from 0. */
export function appliedTo(force, k) {
  return force.filter(({ cylinder }) => cylinder === null || cylinder === k + 1);
}

/** What acts on a piston at a cycle angle [rad] and a position [m] but for what drags,
 * { steady, jumping } [N]. */
export function appliedAt({ applied, top }, phi, x, x1) {
  if (!applied.length) return NONE;
  const found = { steady: 0, jumping: 0 };
  for (const law of applied) {
    addOverTravel(found, law, top - x, x1);
    if (law.over_angle) found.steady += valueAt(law.over_angle, phi);
  }
  return found;
}

function addOverTravel(found, { forward, back }, s, x1) {
  if (forward === null) return;
  const towards = lineAt(forward, s, x1);
  const away = back === null ? towards : lineAt(back, s, x1);
  found.steady += 0.5 * (towards + away);
  found.jumping += 0.5 * (away - towards);
}

/** A line over the displacement s [m], of that which holds just beyond. */
function lineAt({ knots, pieces }, s, x1) {
  const k = 3 * countUpTo(knots, s - KNOT * x1);
  return pieces[k] + pieces[k + 1] * s;
}

/** The whole force on a piston [N] at a speed [rad/s]. */
export function appliedForce(gear, at, omega) {
  const { steady, jumping } = appliedAt(gear, at.phi, at.x, at.x1);
  const drag = gear.applied.reduce((sum, { viscous }) => sum + viscous, 0);
  const turns = jumping === 0 ? 0 : slides(gear.shape, at.phi, omega) * jumping;
  return steady - turns + drag * at.x1 * omega;
}

/** Crank angles of a period at which the forces on each piston bend or jump [rad]; strong : only
 * where a screen would show it. */
export function appliedMarks(applied, shapes, cylinders, period, strong) {
  const found = [];
  applied.forEach((laws, k) => {
    const { phase } = cylinders[k];
    for (const { forward, back, over_angle: cycle } of laws) {
      if (back !== null) found.push(...centresOver(shapes[k], phase, period));
      for (const line of [forward, back]) {
        if (line !== null) found.push(...travelMarks(line, shapes[k], phase, period, strong));
      }
      if (cycle) found.push(...knotsOver(strong ? strongOf([cycle])[0] : cycle, phase, period));
    }
  });
  return found;
}

/** The same of a line over the travel. */
function travelMarks({ knots, jumps }, shape, phase, period, strong) {
  const stroke = strokeOf(shape);
  const found = [];
  for (const knot of strong ? jumps : knots) {
    if (!(knot > 0 && knot < stroke)) continue;
    const angles = throwAngles(knot, stroke - knot, shape);
    found.push(...repeated(angles.map((angle) => angle - phase), period));
  }
  return found;
}
