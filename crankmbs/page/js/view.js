/** What is looked at: the first view of a scene, and all that an address may say. */
import { DEGREE } from "./format.js";
import { choices } from "./quantities.js";

const FORCES = ["piston", "rod", "crank", "none"];

/** What is looked at first. */
export function firstView({ scene }) {
  const gassed = scene.gas !== null;
  const lower = gassed ? "torque of the cylinder" : "piston acceleration";
  const upper = scene.motion === null ? "crank speed" : "piston acceleration";
  const below = upper === lower ? "side force on the piston" : lower;
  return { cylinder: "1", forces: "piston", upper, lower: below, angle: null };
}

/** Everything that may stand in an address. */
export function keysOf({ scene, knobs, words }) {
  const { curves, diagrams } = choices(scene);
  const shown = [...curves, ...diagrams];
  return [
    ...knobs,
    ...words,
    { name: "cylinder", words: ["1", "2", "3", "4", "5", "6", "7", "8"] },
    { name: "forces", words: FORCES },
    { name: "upper", words: shown },
    { name: "lower", words: shown },
    { name: "angle", low: -1e6, high: 1e6 },
  ];
}

/** Where crank, rod and arrows are apart: 30 degrees after the firing dead centre. */
export function tellingPose(cycle) {
  const { train, scene } = cycle;
  const firing = scene.period > 3 * Math.PI && train.pressure.length ? 2 * Math.PI : 0;
  return cycle.within(firing + Math.PI / 6 - train.cylinders[0].phase);
}

/** The ends of a cycle [deg]. */
export function spanOf({ from, to }) {
  return { low: Math.min(from, to) / DEGREE, high: Math.max(from, to) / DEGREE };
}
