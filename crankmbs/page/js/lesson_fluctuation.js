/** Constant speed or not: what a flywheel lets through, and what it costs a formula. */
import { remembering } from "./arrays.js";
import { cycleOf } from "./cycle.js";
import { Engine } from "./engine.js";
import { RPM, readable } from "./format.js";
import { LECTURES, lecturedAt } from "./lecture.js";
import { begun } from "./lesson.js";
import { diagram, overAngle, sizeOf, spread } from "./shapes.js";

const COUNT = 24; // flywheels of the curve
const EXACT = LECTURES["untruncated lecture"];
const QUANTITIES = {
  "piston acceleration": { unit: "m/s²", si: 1, of: (f) => f.cylinders[0]["piston acceleration"] },
  "side thrust": { unit: "kN", si: 1e3, of: (f) => f.cylinders[0]["side thrust"] },
  "crank pin force, axial": { unit: "kN", si: 1e3, of: (f) => f.cylinders[0]["crank pin force x"] },
  "torque of the cylinder": { unit: "N m", si: 1, of: (f) => f.cylinders[0].torque },
};

export function start() {
  return begun({ swing: SWING, fall: FALL, cost: COST });
}

const SWING = {
  shapes: (cycle) => {
    const curves = [
      { name: "simulated", of: (v) => v.crank_speed / RPM },
      { name: "constant speed", style: "plain", of: () => cycle.mean / RPM },
    ];
    const mean = Math.abs(cycle.mean) / RPM;
    const holds = { y: [0.94 * mean, 1.06 * mean] };
    return [overAngle(cycle, { title: "crank speed", unit: "rpm", curves, holds })];
  },
  says: (cycle) => ({
    delta: `${readable(100 * cycle.fluctuation, 2)} %`,
    mean: `${readable(cycle.mean / RPM, 1)} rpm`,
  }),
};

/** The fluctuation over the flywheel, from one settled run for each, and by the textbook. */
const FALL = {
  shapes: (cycle, { flywheel }, given) => {
    const { inertias, runs } = fallOf(given, cycle.scene);
    const { work, moving } = given.textbook;
    const squared = cycle.mean ** 2;
    const textbook = inertias.map((inertia) => (100 * work) / ((inertia + moving) * squared));
    return [diagram({
      title: "coefficient of fluctuation",
      right: { text: "inertia of crank and flywheel", unit: "kg m²" },
      up: { text: "coefficient of fluctuation", unit: "%" },
      curves: [
        { name: "simulated", x: inertias, y: runs },
        { name: "W / (J ω²)", style: "exact", x: inertias, y: textbook },
      ],
      of: () => [flywheel, 100 * cycle.fluctuation],
      holds: { x: [0], y: [0] },
    })];
  },
  says: (cycle) => ({ delta: `${readable(100 * cycle.fluctuation, 2)} %` }),
};

const fallOf = remembering((given, scene) => {
  const engine = new Engine(given.rules);
  const { low, high } = given.figures.find(({ name }) => name === "fall").knobs[0];
  const inertias = spread(0, 1, COUNT).map((part) => low * (high / low) ** part);
  let warm = null;
  const runs = inertias.map((inertia) => {
    const heavier = { ...scene, crank: { ...scene.crank, inertia } };
    warm = cycleOf(engine, heavier, given.endings, { warm });
    return 100 * warm.fluctuation;
  });
  return { inertias, runs };
}, (given) => [given]);

const COST = {
  shapes: (cycle, { quantity }) => {
    const { unit, si, of } = QUANTITIES[quantity];
    const at = (row) => of(lecturedAt(cycle.train, EXACT, row)) / si;
    const even = cycle.rows.map((row) => at({ ...row, omega: cycle.mean, alpha: 0 }));
    const curves = [
      { name: "as it swings", of: ({ crank_angle: theta }) => at(cycle.motion.at(theta)) },
      { name: "constant speed", style: "exact", y: even },
    ];
    const apart = [["as it swings − constant speed", 0, 1]];
    return [overAngle(cycle, { title: quantity, unit, curves, apart })];
  },
  says: (cycle, { quantity }) => {
    const [{ curves: [{ y }], differences: [{ y: off }] }] = COST.shapes(cycle, { quantity });
    return { share: `${readable((100 * sizeOf([off])) / sizeOf([y]), 2)} %` };
  },
};
