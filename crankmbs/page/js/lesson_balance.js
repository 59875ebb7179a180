/** Several cylinders: which orders of force, couple and torque are left. */
import { KN, readable } from "./format.js";
import { begun } from "./lesson.js";
import { diagram, overAngle } from "./shapes.js";
import { add, set } from "./svg.js";

const HIGHEST = 6; // order shown
const UNITS = 1000; // of the drawing per metre

export function start() {
  return begun({ shake: SHAKE, couple: COUPLE, torque: TORQUE, twin: TWIN });
}

const SHAKE = {
  scene: (turner, values) => shaken(turner.scene(values)),
  shapes: (cycle) => {
    const { scene: { piston, crank, rod }, mean } = cycle;
    const unit = (cylinders) => (piston.mass * crank.radius * mean ** 2 * cylinders) / KN;
    const ratio = crank.radius / rod.length;
    const order = (n, size) => ({ crank_angle: theta }) => -unit(1) * size *
      cycle.train.cylinders.reduce((sum, { phase }) => sum + Math.cos(n * (theta + phase)), 0);
    const curves = [
      { name: "simulated", of: (v) => -v.frame_force_x / KN },
      { name: "first order", style: "exact", of: order(1, 1) },
      { name: "second order", style: "second", of: order(2, ratio) },
    ];
    const most = unit(1) * 1.4;
    const title = "force on the frame, towards the crank";
    const over = overAngle(cycle, { title, unit: "kN", curves, holds: { y: [-most, most] } });
    return [over, sticks(cycle, over.curves[0].y, "kN", most)];
  },
  says: (cycle) => {
    const forces = cycle.samples.map((v) => v.frame_force_x / KN);
    const at = (order) => orderOf(cycle, forces, order).size;
    return { first: `${readable(at(1), 2)} kN`, second: `${readable(at(2), 2)} kN` };
  },
};

const COUPLE = {
  scene: (turner, values, { spacing }) => {
    const scene = shaken(turner.scene(values));
    const middle = 0.5 * (scene.cylinders.length - 1);
    return { ...scene, levers: scene.cylinders.map((_, k) => (k - middle) * spacing) };
  },
  shapes: (cycle) => {
    const curves = [{ name: "couple", of: (v) => v.rocking_moment_y }];
    const { scene: { piston, crank }, mean, train: { levers } } = cycle;
    const far = levers[levers.length - 1] || 0;
    const most = 2.2 * far * piston.mass * crank.radius * mean ** 2;
    return [overAngle(cycle, {
      title: "rocking couple about Y", unit: "N m", curves, holds: { y: [-most, most] },
    })];
  },
  says: (cycle) => {
    const values = cycle.samples.map((v) => Math.abs(v.rocking_moment_y));
    const most = `${readable(Math.max(...values), 0)} N m`;
    const count = cycle.train.cylinders.length;
    return {
      most,
      words: most === "0 N m"
        ? `The pistons of ${count} cylinders move as mirror images about the middle of the ` +
          "crank: both ends are pushed alike, and nothing rocks the engine."
        : `The forces of ${count} cylinders sum to nothing in the first order, but they do not ` +
          "act in one place: seen from the side, one end of the engine is pushed up while the " +
          "other is pulled down.",
    };
  },
  draw: drawRow,
};

const TORQUE = {
  shapes: (cycle) => {
    const of = (v) => v.cylinders.reduce((sum, each) => sum + each.crank_torque, 0);
    const values = cycle.samples.map(of);
    const mean = values.slice(1).reduce((sum, each) => sum + each, 0) / (values.length - 1);
    const curves = [
      { name: "all cylinders", of },
      { name: "mean", style: "plain", of: () => mean },
    ];
    const over = overAngle(cycle, { title: "torque on the crank", unit: "N m", curves });
    return [over, sticks(cycle, over.curves[0].y, "N m", 0)];
  },
  says: (cycle) => {
    const half = 0.5 * cycle.train.cylinders.length;
    return { orders: [1, 2, 3].map((n) => readable(n * half, half % 1 ? 1 : 0)).join(", ") };
  },
};

const TWIN = {
  scene: (turner, { bank, weight }) => {
    const scene = shaken(turner.scene({}));
    const half = (bank * Math.PI) / 360;
    const cylinders = [{ phase: half, bank: -half }, { phase: -half, bank: half }];
    const mass = (weight / 100) * scene.piston.mass;
    const crank = { ...scene.crank, mass, center_of_mass: -scene.crank.radius, inertia: 1 };
    return { ...scene, cylinders, crank };
  },
  shapes: (cycle) => {
    const { scene: { piston, crank }, mean } = cycle;
    const force = (v) => [v.frame_force_y / KN, v.frame_force_x / KN];
    const points = cycle.samples.map(force);
    const first = [0, 1].map((axis) => partOf(cycle, points.map((each) => each[axis]), 1));
    const most = (2.1 * piston.mass * crank.radius * mean ** 2) / KN;
    return [diagram({
      title: "force of both pistons and the weight on the frame",
      equal: true,
      right: { text: "force along Y", unit: "kN" },
      up: { text: "force along X", unit: "kN" },
      curves: [
        { name: "simulated", x: points.map(([x]) => x), y: points.map(([, y]) => y) },
        { name: "its first order", style: "exact", x: first[0], y: first[1] },
      ],
      of: (theta) => force(cycle.at(theta)),
      holds: { x: [-most, most], y: [-most, most] },
    })];
  },
  says: (cycle) => {
    const { samples } = cycle;
    const of = (axis) =>
      orderOf(cycle, samples.map((v) => v[`frame_force_${axis}`] / KN), 1).size;
    return { first: `${readable(Math.max(of("x"), of("y")), 2)} kN` };
  },
};

/** A machine of which only what goes to and fro shakes: no gas, the rod as its share of mass. */
function shaken(scene) {
  const { rod, piston, crank } = scene;
  const mass = piston.mass + (rod.mass * rod.center_of_mass) / rod.length;
  return {
    ...scene,
    gas: null,
    fuel: null,
    gravity: null,
    rod: { ...rod, mass: 0, inertia: 0 },
    piston: { ...piston, mass },
    crank: { ...crank, mass: 0, center_of_mass: 0 },
  };
}

/** The amplitude of an order of values at a cycle's samples, { order, size, cos, sin }. */
function orderOf({ angles }, values, order) {
  const count = values.length - 1;
  let [cos, sin] = [0, 0];
  for (let k = 0; k < count; k++) {
    cos += (2 / count) * values[k] * Math.cos(order * angles[k]);
    sin += (2 / count) * values[k] * Math.sin(order * angles[k]);
  }
  return { order, size: Math.hypot(cos, sin), cos, sin };
}

/** One order of values, at the samples. */
function partOf(cycle, values, wanted) {
  const part = orderOf(cycle, values, wanted);
  return cycle.angles.map((theta) =>
    part.cos * Math.cos(wanted * theta) + part.sin * Math.sin(wanted * theta));
}

/** Orders as sticks on a line. */
function sticks(cycle, values, unit, most) {
  const turns = Math.abs(cycle.to - cycle.from) / (2 * Math.PI);
  const orders = Array.from({ length: Math.round(HIGHEST * turns) }, (_, n) =>
    orderOf(cycle, values, (n + 1) / turns));
  return diagram({
    title: "orders",
    right: { text: "order", unit: "per turn" },
    up: { text: "amplitude", unit },
    curves: [{
      name: "amplitude",
      x: [0, ...orders.flatMap(({ order }) => [order, order, order]), HIGHEST],
      y: [0, ...orders.flatMap(({ size }) => [0, size, 0]), 0],
    }],
    of: () => [0, 0],
    holds: { y: [0, most] },
  });
}

/** The crank seen from the side, at a crank angle: pistons in a row, and the force of each on the
 * frame, in an svg of a size [px] with letters of a type. */
function drawRow(svg, cycle, theta, { width, height, type }) {
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
