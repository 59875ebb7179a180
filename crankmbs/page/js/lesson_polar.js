/** Reading a bearing polar: every point is a force, its direction and its size. */
import { DEGREE, KN, readable } from "./format.js";
import { begun } from "./lesson.js";
import { drawn } from "./quantities.js";
import { diagram, overAngle } from "./shapes.js";

const TEN = 10 * DEGREE;
const DIRECTIONS = 180; // at which the load of the pin's surface is looked at
const WIDE = Math.PI / 3; // rad to either side: how far a load presses on the surface

export function start() {
  return begun({ bearing: BEARING, pin: PIN, turning: TURNING });
}

const BEARING = {
  shapes: (cycle) => {
    const size = (v) => Math.hypot(v.main_bearing_force_x, v.main_bearing_force_y) / KN;
    const curves = [{ name: "size", of: size }];
    const over = overAngle(cycle, { title: "size of the force", unit: "kN", curves });
    return [run("main bearing, polar", cycle), over];
  },
  says: (cycle) => largest(cycle, "main bearing", (v) =>
    [v.main_bearing_force_x, v.main_bearing_force_y]),
};

const PIN = {
  shapes: (cycle) => [run("crank pin, polar", cycle)],
  says: (cycle) => largest(cycle, "crank pin", (v) =>
    [v.cylinders[0].crank_pin_force_x, v.cylinders[0].crank_pin_force_y]),
};

const TURNING = {
  shapes: (cycle) => {
    const { phase } = cycle.train.cylinders[0];
    const force = (v) => onPin(v, phase).map((each) => each / KN).reverse();
    const points = cycle.samples.map(force);
    const across = points.map(([a]) => a);
    const along = points.map(([, b]) => b);
    const { x, y } = outline(cycle, points);
    return [diagram({
      title: "force of the rod on the pin, as the pin feels it",
      equal: true,
      right: { text: "across the crank", unit: "kN" },
      up: { text: "outwards along the crank", unit: "kN" },
      curves: [
        { name: "force on the pin", x: across, y: along },
        { name: "where it is loaded least", style: "second", x, y },
        dots(cycle, across, along),
      ],
      of: (theta) => force(cycle.at(theta)),
    })];
  },
  says: (cycle) => {
    const { phase } = cycle.train.cylinders[0];
    const { angle } = leastLoaded(cycle.samples.map((v) => onPin(v, phase)));
    return { hole: `${readable(angle / DEGREE, 0)}°` };
  },
};

/** The simulated curve of a polar, with dots. */
function run(name, cycle) {
  const shape = drawn(name, cycle, 0);
  const [{ x, y }] = shape.curves;
  return { ...shape, curves: [shape.curves[0], dots(cycle, x, y)] };
}

/** A dot every ten degrees of the crank angle, as a line with gaps. */
function dots({ angles }, x, y) {
  const step = TEN / Math.abs(angles[1] - angles[0]);
  const count = Math.floor((angles.length - 1) / step + 1e-9);
  const at = Array.from({ length: count + 1 }, (_, n) => Math.round(n * step));
  const gaps = (values) => at.flatMap((k) => [values[k], values[k], NaN]);
  return { name: "every 10°", style: "dots", x: gaps(x), y: gaps(y) };
}

/** In words the largest force of a cycle in a joint, and at which crank angle; in the quick pass
 * that of the samples. */
function largest({ samples, measures }, joint, of) {
  const { peak, crank_angle: theta } = measures?.joints.find((each) => each.joint === joint) ??
    samples.map((v) => ({ peak: Math.hypot(...of(v)), crank_angle: v.crank_angle }))
      .reduce((best, each) => (each.peak > best.peak ? each : best));
  return { peak: `${readable(peak / KN, 2)} kN`, angle: `${readable(theta / DEGREE, 0)}°` };
}

/** The force of the rod on the pin [N]: outwards along the crank, and across it. */
function onPin({ crank_angle: theta, cylinders: [at] }, phase) {
  const [sin, cos] = [Math.sin(theta + phase), Math.cos(theta + phase)];
  const [x, y] = [-at.crank_pin_force_x, -at.crank_pin_force_y];
  return [x * cos + y * sin, y * cos - x * sin];
}

/** Where on its surface the pin is pressed least over a cycle, an angle from outwards [rad]: a
 * force presses on the side from which it comes, and on what lies within 60 degrees of that. */
function leastLoaded(forces) {
  const found = Array.from({ length: DIRECTIONS }, (_, n) => {
    const angle = -Math.PI + (2 * Math.PI * n) / DIRECTIONS;
    let load = 0;
    for (const [along, across] of forces) {
      const off = Math.cos(Math.atan2(-across, -along) - angle);
      if (off >= Math.cos(WIDE)) load += Math.hypot(along, across) * off;
    }
    return { angle, load };
  });
  return found.reduce((best, each) => (each.load < best.load ? each : best));
}

/** A ray from the middle to where the pin is loaded least. */
function outline({ samples, train: { cylinders: [{ phase }] } }, points) {
  const { angle } = leastLoaded(samples.map((v) => onPin(v, phase)));
  const far = 0.8 * Math.max(...points.map(([x, y]) => Math.hypot(x, y)));
  return { x: [0, far * Math.sin(angle)], y: [0, far * Math.cos(angle)] };
}
