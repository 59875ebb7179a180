/** What the plots can show: quantities over the crank angle, and diagrams of two of them. */
import { DEGREE, RPM } from "./format.js";
import { topPosition } from "./geometry.js";
import { diagram, overAngle, sizeOf } from "./shapes.js";

const EXACT = "untruncated lecture";
const LECTURE = "S1 (motion and forces truncated)";

/** The three curves of a quantity, by what made them. */
export const CURVES = ["simulated", "untruncated", "lecture"];

/** Quantities by name: unit, its SI value, `of` a sample and a cylinder; `said` by the formulas;
 * cylinder : whether the variables of the motion and one cylinder are enough; run : what of a cycle
 * has it at the samples. */
const QUANTITIES = {
  "crank speed": {
    unit: "rpm", si: RPM, run: "speeds", of: (v) => v.crank_speed, even: (c) => c.mean,
  },
  "crank ahead of the mean": { unit: "°", si: DEGREE, run: "leads", even: () => 0 },
  "turning moment": {
    unit: "N m",
    si: 1,
    of: (v) => sum(v.cylinders, (each) => each.crank_torque),
    said: (found) => sum(found.cylinders, (each) => each.torque),
  },
  "torque of the cylinder": own("N m", 1, "crank_torque", "torque"),
  "piston displacement": {
    ...own("mm", 1e-3, "piston_displacement", "piston displacement"),
    datum: ({ radius, length, offset }) =>
      radius + length - topPosition({ radius, length, offset }),
  },
  "piston velocity": own("m/s", 1, "piston_velocity", "piston velocity"),
  "piston acceleration": own("m/s²", 1, "piston_acceleration", "piston acceleration"),
  "gas pressure": own("bar", 1e5, "gas_pressure"),
  "crank end pressure": own("bar", 1e5, "crank_end_pressure"),
  "applied force": own("N", 1, "applied_force"),
  "side force on the piston": own("N", 1, "side_force", "side thrust"),
  "piston pin force, axial": own("N", 1, "piston_pin_force_x", "piston pin force x"),
  "crank pin force, axial": own("N", 1, "crank_pin_force_x", "crank pin force x"),
  "crank pin force, across": own("N", 1, "crank_pin_force_y", "crank pin force y"),
  "main bearing force, X": whole("main_bearing_force_x", "main bearing force x"),
  "main bearing force, Y": whole("main_bearing_force_y", "main bearing force y"),
  "frame force, X": whole("frame_force_x"),
  "frame force, Y": whole("frame_force_y"),
};

/** Diagrams by name: what goes right and up, each [text, unit, SI value, of a sample]; one of equal
 * scales has X up and Y to the left, as the mechanism beside it. */
const DIAGRAMS = {
  "p-V diagram": {
    right: ["swept volume", "cm³", 1e-6, (v, k, c) =>
      v.cylinders[k].piston_displacement * (c.train.gears[k].piston.area ?? 0)],
    up: ["gas pressure", "bar", 1e5, (v, k) => v.cylinders[k].gas_pressure],
    crankEnd: [
      (v, k, { train: { gears } }) => v.cylinders[k].piston_displacement *
        gears[k].piston.crank_end_share * gears[k].piston.area,
      (v, k) => v.cylinders[k].crank_end_pressure,
    ],
  },
  "main bearing, polar": polar("main bearing force", (v) => v, (f) => f),
  "crank pin, polar": {
    ...polar("crank pin force", (v, k) => v.cylinders[k], (f, k) => f.cylinders[k]),
    cylinder: true,
  },
  "frame force, polar": {
    equal: true,
    right: ["frame force Y", "N", 1, (v) => v.frame_force_y],
    up: ["frame force X", "N", 1, (v) => v.frame_force_x],
  },
};

function own(unit, si, name, said) {
  const of = (key) => key && ((v, k) => v.cylinders[k][key]);
  return { unit, si, cylinder: true, of: of(name), said: of(said) };
}

function whole(name, said) {
  const of = (key) => key && ((v) => v[key]);
  return { unit: "N", si: 1, of: of(name), said: of(said) };
}

function polar(name, of, said) {
  const key = name.replaceAll(" ", "_");
  return {
    equal: true,
    right: [`${name} Y`, "N", 1, (v, k) => of(v, k)[`${key}_y`], (f, k) => said(f, k)[`${name} y`]],
    up: [`${name} X`, "N", 1, (v, k) => of(v, k)[`${key}_x`], (f, k) => said(f, k)[`${name} x`]],
  };
}

function sum(list, part) {
  return list.reduce((total, each) => total + part(each), 0);
}

/** The names of what a plot can show of a scene: first curves, then diagrams. */
export function choices(scene) {
  const { gas, force } = scene;
  const there = (name) => {
    if (name === "applied force") return force.length > 0;
    if (/crank end/.test(name)) return gas !== null && gas.crank_end.length > 0;
    return gas !== null || !/pressure|p-V/.test(name);
  };
  const [curves, diagrams] = [QUANTITIES, DIAGRAMS].map((all) => Object.keys(all).filter(there));
  return { curves, diagrams };
}

/** What a plot draws of a cycle: { title, right, up, curves: [{ name, x, y }], differences }.
 *
 * name : of a quantity or diagram; k : number of the cylinder from 0
 */
export function drawn(name, cycle, k) {
  return name in DIAGRAMS ? inDiagram(name, cycle, k) : curvesOver(name, cycle, k);
}

function curvesOver(name, cycle, k) {
  const quantity = QUANTITIES[name];
  const values = curvesOf(quantity, cycle, k);
  const { unit, si } = scaled(quantity.unit, quantity.si, sizeOf(values.map(({ y }) => y)));
  const curves = values.map(({ name: what, y }) => ({ name: what, y: y.map((v) => v / si) }));
  const pairs = quantity.even ? [] : curves.slice(1); // else the curve again
  return overAngle(cycle, {
    title: name,
    unit,
    curves,
    apart: pairs.map((next, n) => [`${curves[n].name} − ${next.name}`, n, n + 1]),
    of: (theta) => (quantity.of ? quantity.of(cycle.at(theta), k) : cycle.leadAt(theta)) / si,
  });
}

function curvesOf(quantity, cycle, k) {
  const run = cycle[quantity.run] ??
    cycle.samplesOf(quantity.cylinder ? k : null).map((v) => quantity.of(v, k));
  const found = [{ name: CURVES[0], y: run }];
  if (quantity.even) found.push({ name: "constant speed", y: run.map(() => quantity.even(cycle)) });
  if (!quantity.said) return found;
  const datum = quantity.datum ? quantity.datum(cycle.train.gears[k].shape) : 0;
  const only = quantity.cylinder ? k : null;
  const said = [EXACT, LECTURE].map((lecture, n) => ({
    name: CURVES[n + 1],
    y: cycle.lectured(lecture, only).map((each) => quantity.said(each, k) - datum),
  }));
  return [...found, ...said];
}

function inDiagram(name, cycle, k) {
  const { right, up, crankEnd, equal = false, cylinder = false } = DIAGRAMS[name];
  const double = crankEnd && cycle.train.crank_end.length > 0;
  const first = double ? "head end" : CURVES[0];
  const pairs = [{ name: first, ...along(cycle.samples, right[3], up[3], k, cycle) }];
  if (double) pairs.push({ name: "crank end", ...along(cycle.samples, ...crankEnd, k, cycle) });
  if (right[4]) {
    const says = cycle.lectured(LECTURE, cylinder ? k : null);
    pairs.push({ name: CURVES[2], ...along(says, right[4], up[4], k, cycle) });
  }
  const [wide, size] = ["x", "y"].map((axis) => sizeOf(pairs.map((each) => each[axis])));
  const sizes = equal ? [Math.max(size, wide), Math.max(size, wide)] : [wide, size];
  const scales = [right, up].map(([, unit, si], n) => scaled(unit, si, sizes[n]));
  const over = (values, n) => values.map((value) => value / scales[n].si);
  return diagram({
    title: name,
    equal,
    right: { text: right[0], unit: scales[0].unit },
    up: { text: up[0], unit: scales[1].unit },
    curves: pairs.map((each) => ({ ...each, x: over(each.x, 0), y: over(each.y, 1) })),
    of: (theta) => {
      const v = cycle.at(theta);
      return [right[3](v, k, cycle) / scales[0].si, up[3](v, k, cycle) / scales[1].si];
    },
  });
}

function along(samples, right, up, k, cycle) {
  return {
    x: samples.map((v) => right(v, k, cycle)),
    y: samples.map((v) => up(v, k, cycle)),
  };
}

/** N becomes kN where that reads better. */
function scaled(unit, si, size) {
  return unit === "N" && size >= 1e3 ? { unit: "kN", si: 1e3 } : { unit, si };
}
