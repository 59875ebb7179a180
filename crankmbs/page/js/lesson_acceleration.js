/** Velocity and acceleration: the least acceleration leaves bottom dead centre. */
import { rootIn } from "./arrays.js";
import { DEGREE, readable } from "./format.js";
import { begun } from "./lesson.js";
import { diagram, overAngle, ratioOf, spread } from "./shapes.js";

const LIMIT = (Math.sqrt(21) - 3) / 6; // of the rod ratio: above it the minimum leaves

export function start() {
  return begun({ motion: MOTION, valley: VALLEY, fork: FORK });
}

/** Velocity and acceleration of the piston, without units, and of two harmonics. */
const MOTION = {
  shapes: (cycle) => {
    const { radius: r } = cycle.train.shape;
    const ratio = ratioOf(cycle);
    const over = (title, range, of, harmonics) => overAngle(cycle, {
      title,
      unit: "",
      curves: [
        { name: "piston", of },
        { name: "two harmonics", style: "exact", of: (v) => harmonics(v.crank_angle) },
      ],
      holds: { y: range },
    });
    return [
      over("velocity over rω", [-1.2, 1.2],
        (v) => v.cylinders[0].piston_velocity / (r * v.crank_speed),
        (phi) => Math.sin(phi) + 0.5 * ratio * Math.sin(2 * phi)),
      over("acceleration over rω²", [-1.1, 1.6],
        (v) => accelerationIn(v, r),
        (phi) => Math.cos(phi) + ratio * Math.cos(2 * phi)),
    ];
  },
};

const VALLEY = {
  shapes: (cycle) => [valley(cycle)],
  says: (cycle) => {
    const at = leastAngle(ratioOf(cycle)) / DEGREE;
    const both = `at ${readable(at, 2)}° and ${readable(360 - at, 2)}°`;
    const places = at > 179.995 ? "at 180°" : both;
    return { least: places, ratio: readable(ratioOf(cycle), 3) };
  },
};

const FORK = {
  shapes: (cycle) => [fork(cycle)],
  says: (cycle) => ({ ratio: readable(ratioOf(cycle), 4), limit: readable(LIMIT, 4) }),
};

/** The crank angle of the least acceleration [rad], up to bottom dead centre: where the third
 * derivative of the displacement is zero, found by halving. */
function leastAngle(ratio) {
  if (ratio <= LIMIT) return Math.PI;
  return rootIn((phi) => third(phi, ratio), Math.PI / 2, Math.PI - 1e-9);
}

/** The third derivative of the displacement over the crank radius: that of
 * cos phi + lambda (cos 2 phi + lambda^2 sin^4 phi) / cos^3 beta. */
function third(phi, ratio) {
  const [s, c] = [Math.sin(phi), Math.cos(phi)];
  const root = Math.sqrt(1 - (ratio * s) ** 2);
  const u = s * c; // s'' holds lambda (cos 2 phi + lambda^2 sin^4 phi) / root^3
  const inner = c * c - s * s + ratio ** 2 * s ** 4;
  const slope = -4 * u + 4 * ratio ** 2 * s ** 3 * c;
  return -s + ratio * (slope / root ** 3 + (3 * ratio ** 2 * u * inner) / root ** 5);
}

/** The acceleration of a piston over that of the crank pin. */
function accelerationIn(v, r) {
  return v.cylinders[0].piston_acceleration / (r * v.crank_speed ** 2);
}

/** The acceleration near bottom dead centre, enlarged, as a diagram over the angle. */
function valley(cycle) {
  const { radius: r } = cycle.train.shape;
  const ratio = ratioOf(cycle);
  const angles = spread(125, 235, 110);
  const of = (theta) => accelerationIn(cycle.at(theta), r);
  const bottom = of(Math.PI);
  const scaled = (theta) => of(theta) - bottom;
  const truncated = (theta) => Math.cos(theta) + ratio * Math.cos(2 * theta) + 1 - ratio;
  const within = (theta) => Math.min(Math.max(theta / DEGREE, 125), 235);
  const least = leastAngle(ratio) / DEGREE;
  const lowest = [least, 360 - least].map((at) => [at, scaled(at * DEGREE)]);
  return diagram({
    title: "acceleration near bottom dead centre",
    right: { text: "angle after top dead centre", unit: "degrees" },
    up: { text: "rise from bottom dead centre, over rω²", unit: "" },
    curves: [
      { name: "piston", x: angles, y: angles.map((at) => scaled(at * DEGREE)) },
      {
        name: "two harmonics",
        style: "exact",
        x: angles,
        y: angles.map((at) => truncated(at * DEGREE)),
      },
      ...lowest.map(([x, y], n) => ({
        name: n ? "" : "lowest", style: n ? "dots unnamed" : "dots", x: [x, x], y: [y, y + 1e-6],
      })),
    ],
    of: (theta) => [within(theta), scaled(within(theta) * DEGREE)],
    holds: { y: [-0.03, 0.06] },
  });
}

/** Where the acceleration is least, over the rod ratio: a fork. */
function fork(cycle) {
  const ratios = spread(0.15, 0.45, 300);
  const series = (ratio) => (ratio <= 0.25 ? Math.PI : Math.acos(-0.25 / ratio));
  const degrees = (of) => ratios.map((ratio) => of(ratio) / DEGREE);
  const other = (values) => values.map((each) => 360 - each);
  const [exact, truncated] = [degrees(leastAngle), degrees(series)];
  const at = ratioOf(cycle);
  return diagram({
    title: "crank angle of the least acceleration",
    right: { text: "rod ratio r/l", unit: "" },
    up: { text: "crank angle", unit: "degrees" },
    curves: [
      { name: "exact", x: ratios, y: exact },
      { name: "truncated formula", style: "exact", x: ratios, y: truncated },
      { name: "", style: "simulated unnamed", x: ratios, y: other(exact) },
      { name: "", style: "exact unnamed", x: ratios, y: other(truncated) },
    ],
    of: () => [at, leastAngle(at) / DEGREE],
    holds: { y: [110, 250] },
  });
}
