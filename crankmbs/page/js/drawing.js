/** Sizes of the drawing that a scene does not say, and its places on the screen.
 *
 * X, to the head, points up and Y to the left, so that counter-clockwise stays so. Lengths are in
 * metres times a scale.
 */
import { bottomPosition, topPosition, turnedBy } from "./geometry.js";

const CROWN = 0.4; // of the piston's width, above its pin
const SKIRT = 0.3;
const CLEARANCE = 1 / 14; // of the stroke
const RIM = 1.65; // of the crank radius: the flywheel's rim, at the inertia that the scene has
const WIDEST = 2.5;
const ROOM = 0.7; // of the crank radius

/** The proportions of a machine [m], and under `each` those of its cylinders; r is the longest
 * throw. ratio : of the flywheel's inertia to that of the scene */
export function proportions(train, ratio, compression) {
  const each = train.gears.map((gear) => cylinderOf(gear, compression));
  const r = Math.max(...each.map((one) => one.r));
  const ring = WIDEST * r;
  const corners = train.cylinders.flatMap(({ bank }, k) => endsOf(each[k], bank));
  const edge = ring + 0.15 * r;
  const step = 0.1 * r; // it is not drawn anew to another scale with every little change
  const reach = (ends) => Math.max(edge, step * Math.ceil(Math.max(...ends) / step));
  const far = reach(corners.map(([y]) => Math.abs(y)));
  const high = reach(corners.map(([, x]) => x));
  const bounds = { left: -far, top: -high, width: 2 * far, height: high + edge };
  return { each, r, rim: rimOf(r, ratio), ring, bounds };
}

function cylinderOf({ shape, piston }, compression) {
  const { radius: r, length, offset } = shape;
  const width = piston.area ? Math.sqrt((4 * piston.area) / Math.PI) : 1.6 * r;
  const top = topPosition(shape);
  const bottom = bottomPosition(shape);
  const clearance = compression ? (top - bottom) / (compression - 1) : CLEARANCE * (top - bottom);
  const head = top + CROWN * width + clearance;
  const low = bottom - SKIRT * width;
  const above = piston.area ? ROOM * r : 0; // for the arrow of the gas
  const [crown, skirt] = [CROWN * width, SKIRT * width];
  return { r, length, offset, width, head, low, above, crown, skirt };
}

/** How far a cylinder reaches, [Y, X] of its corners and above its head. */
function endsOf({ width, offset, head, above }, bank) {
  const across = 0.62 * width + Math.abs(offset);
  const corners = [-across, across].map((y) => [y * Math.cos(bank) + head * Math.sin(bank),
    head * Math.cos(bank) - y * Math.sin(bank) + 0.1 * width]);
  return [...corners, turnedBy(bank, head + above, 0).reverse()];
}

/** A disc of one thickness: its inertia grows with the fourth power of its radius. */
function rimOf(radius, ratio) {
  return Math.min(RIM * ratio ** 0.25, WIDEST) * radius;
}

/** The inertia, of the scene's, that a rim of this radius stands for. */
export function inertiaOfRim(rim, radius) {
  return (rim / (RIM * radius)) ** 4;
}
