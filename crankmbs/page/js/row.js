/** The crank seen from the side: pistons in a row, and the force of each on the frame. */
import { readable } from "./format.js";
import { add, set } from "./svg.js";

const UNITS = 1000; // of the drawing per metre

/** Draw a cycle at a crank angle into an svg of a size [px] with letters of a type. */
export function drawRow(svg, cycle, theta, { width, height, type }) {
  svg.replaceChildren();
  const { train } = cycle;
  const r = train.shape.radius * UNITS;
  const wide = train.piston.area ? Math.sqrt((4 * train.piston.area) / Math.PI) * UNITS : 1.6 * r;
  const far = Math.abs(train.levers[0]) * UNITS + wide;
  const top = r + train.shape.length * UNITS + 0.4 * wide + 1.6 * r;
  set(svg, { viewBox: `${-far} ${-top} ${2 * far} ${top + 2 * r}` });
  const letters = type / Math.min(width / (2 * far), height / (top + 2 * r));
  add(svg, "line", { x1: -far, x2: far, y1: 0, y2: 0, class: "shaft", "stroke-width": 0.16 * r });
  const v = cycle.at(theta);
  const longest = (1.3 * r) / (train.piston.mass * train.shape.radius * v.crank_speed ** 2);
  train.cylinders.forEach(({ phase }, k) => {
    const x = train.levers[k] * UNITS;
    const { piston_position: pin, piston_acceleration: acceleration } = v.cylinders[k];
    const [throwAt, pinAt] = [-r * Math.cos(theta + phase), -pin * UNITS];
    const line = (y1, y2, kind, across) =>
      add(svg, "line", { x1: x, x2: x, y1, y2, class: kind, "stroke-width": across * r });
    line(throwAt, pinAt, "bar", 0.2);
    line(0, throwAt, "throw", 0.3);
    const crown = pinAt - 0.35 * wide;
    const box = { x: x - 0.42 * wide, y: crown, width: 0.84 * wide, height: 0.6 * wide };
    add(svg, "rect", { ...box, class: "body", "stroke-width": 0.05 * r });
    // inertia pulls where it slows upwards
    const force = longest * train.piston.mass * acceleration;
    const [from, to] = force > 0 ? [crown, crown - force] : [crown + force, crown];
    add(svg, "path", { d: arrow(x, from, to, r), class: "push", "stroke-width": 0.09 * r });
  });
  add(svg, "text", { x: 0, y: 1.7 * r, "font-size": letters },
    `couple ${readable(v.rocking_moment_y, 0)} N m`);
}

/** An upright arrow. */
function arrow(x, from, to, r) {
  const long = Math.abs(to - from);
  if (long < 0.02 * r) return "";
  const back = Math.sign(from - to) * Math.min(0.35 * r, long);
  return `M${x} ${from}V${to + back}M${x - 0.16 * r} ${to + back}h${0.32 * r}L${x} ${to}Z`;
}
