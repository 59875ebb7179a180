/** What the lectures answer at a crank angle: exact for a rod of two masses, or truncated.
 *
 * Their model: gas and the inertia force of the reciprocating mass act along the cylinder, the rod
 * is two masses on a bar without mass, the crank a mass at its radius, nothing has weight. With the
 * rod ratio lambda = r / l and k = e / r the truncated motion and forces stop after the second
 * harmonic. Displacement counts from l + r; a force towards the crank is positive.
 */
import { turnedBy } from "./geometry.js";
import { pressureAt } from "./reactions.js";

/** Piston displacement [m], velocity and acceleration, exact at any angular acceleration; and as
 * parts of the net force the side thrust, N / F = tan beta, and the tangential force on the crank
 * pin, T / F = sin(phi + beta) / cos beta. */
function exact(phi, { radius: r, length: l, offset: e }, omega, alpha) {
  const [across, along] = [Math.sin(phi), Math.cos(phi)];
  const sine = (r * across - e) / l;
  const cosine = Math.sqrt((1 - sine) * (1 + sine));
  const slope = sine / cosine;
  const first = r * (across + along * slope);
  const second = r * (along - across * slope + ((r / l) * along ** 2) / cosine ** 3);
  return {
    displacement: r * (1 - along) + l * (1 - cosine),
    velocity: omega * first,
    acceleration: second * omega ** 2 + first * alpha,
    side: slope,
    turning: first / r,
  };
}

/** The same truncated, at constant speed:
 * s = r [1 - cos phi + (lambda/4)(1 - cos 2 phi) - k lambda sin phi] and its derivatives, of which
 * the first over r is T / F; N / F = lambda (sin phi - k). */
function truncated(phi, { radius: r, length: l, offset: e }, omega) {
  const ratio = r / l;
  const skew = (e / r) * ratio;
  const [across, along] = [Math.sin(phi), Math.cos(phi)];
  const bow = (ratio / 4) * (1 - Math.cos(2 * phi));
  const turning = across + (ratio / 2) * Math.sin(2 * phi) - skew * along;
  return {
    displacement: r * (1 - along + bow - skew * across),
    velocity: r * omega * turning,
    acceleration: r * omega ** 2 * (along + ratio * Math.cos(2 * phi) + skew * across),
    side: ratio * across - skew,
    turning,
  };
}

/** The lectures that are shown, by the names under which they are compared. */
export const LECTURES = {
  "untruncated lecture": exact,
  "S1 (motion and forces truncated)": truncated,
};

/** What is shown of a lecture's formulas: of every cylinder, and of the main bearing; or of
 * cylinder k alone, from 0.
 *
 * sample : { theta, omega, alpha, shares }, with the mean speed and alpha 0 what a lecture would
 * reckon with
 */
export function lecturedAt(train, lecture, sample, k = null) {
  const cylinders = train.cylinders.map((_, n) =>
    (k === null || n === k ? cylinderLectured(train, lecture, sample, n) : null));
  if (k !== null) return { cylinders };
  const { theta, omega, alpha } = sample;
  const { crank } = train;
  const pulls = cylinders.map((found, n) =>
    turnedBy(train.cylinders[n].bank, found["crank pin force x"], found["crank pin force y"]));
  const own = inertiaAtThrow(crank.mass, crank.center_of_mass, theta, omega, alpha);
  const [x, y] = own.map((part, axis) => pulls.reduce((sum, pull) => sum + pull[axis], part));
  return { "main bearing force x": x, "main bearing force y": y, cylinders };
}

/** Those of one cylinder, from number 0. */
function cylinderLectured(train, lecture, sample, number) {
  const { gears, cylinders } = train;
  const { rod, piston, shape } = gears[number];
  const { theta, omega, alpha, shares } = sample;
  const r = shape.radius;
  const phi = theta + cylinders[number].phase;
  const atPistonPin = (rod.mass * rod.center_of_mass) / shape.length;
  const atCrankPin = rod.mass - atPistonPin;
  const moved = lecture(phi, shape, omega, alpha);
  const gas = (piston.area ?? 0) * pressureAt(train, shares, number, phi);
  const forceWith = (mass) => gas - mass * moved.acceleration;
  const net = forceWith(piston.mass + atPistonPin);
  const side = net * moved.side;
  const [turningX, turningY] = inertiaAtThrow(atCrankPin, r, phi, omega, alpha);
  return {
    "piston displacement": moved.displacement,
    "piston velocity": moved.velocity,
    "piston acceleration": moved.acceleration,
    "side thrust": side,
    torque: net * moved.turning * r - atCrankPin * r ** 2 * alpha,
    "piston pin force x": forceWith(piston.mass),
    "crank pin force x": net + turningX,
    "crank pin force y": turningY - side,
  };
}

/** Force that a mass turning at the crank radius needs: inwards, and forwards with alpha [N]. */
function inertiaAtThrow(mass, radius, angle, omega, alpha) {
  const inwards = mass * radius * omega ** 2;
  const forwards = mass * radius * alpha;
  const [sin, cos] = [Math.sin(angle), Math.cos(angle)];
  return [-inwards * cos - forwards * sin, -inwards * sin + forwards * cos];
}
