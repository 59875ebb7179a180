/** Displacement: the piston is past half its stroke when the crank is at 90 degrees. */
import { MM, readable } from "./format.js";
import { bottomPosition, topPosition } from "./geometry.js";
import { begun } from "./lesson.js";
import { overAngle, ratioOf } from "./shapes.js";

const QUARTER = Math.PI / 2;

export function start() {
  return begun({ half: HALF, series: SERIES });
}

const HALF = {
  levels: ({ train: { shape } }) =>
    [[0.5 * (topPosition(shape) + bottomPosition(shape)), "half stroke"]],
  shapes: (cycle) => [piston(cycle, [endless(cycle)])],
  says: (cycle) => ({
    lead: `${readable(leadOf(cycle), 2)} mm`,
    angle: `${readable((Math.acos(0.5 * ratioOf(cycle)) * 180) / Math.PI, 2)}°`,
  }),
};

const SERIES = {
  shapes: (cycle) => {
    const { radius: r } = cycle.train.shape;
    const of = ({ crank_angle: phi }) =>
      (r * (1 - Math.cos(phi) + (ratioOf(cycle) / 4) * (1 - Math.cos(2 * phi)))) / MM;
    const truncated = { name: "two harmonics", style: "exact", of };
    const apart = [["piston − two harmonics", 0, 1]];
    return [piston(cycle, [truncated], { apart, holdsBelow: [0, (r / MM) * 0.004] })];
  },
  says: (cycle) => {
    const { radius: r } = cycle.train.shape;
    const short = leadOf(cycle) - (0.5 * r * ratioOf(cycle)) / MM;
    return { short: `${readable(1e3 * short, 1)} µm` };
  },
};

function piston(cycle, others, about = {}) {
  const of = (v) => v.cylinders[0].piston_displacement / MM;
  const curves = [{ name: "piston", of }, ...others];
  const title = "displacement from top dead centre";
  return overAngle(cycle, { title, unit: "mm", curves, ...about });
}

function endless(cycle) {
  const { radius: r } = cycle.train.shape;
  const of = ({ crank_angle: phi }) => (r * (1 - Math.cos(phi))) / MM;
  return { name: "endless rod", style: "plain", of };
}

/** How far past half its stroke the piston is at 90 degrees [mm]. */
function leadOf(cycle) {
  const [at] = cycle.at(QUARTER).cylinders;
  return (at.piston_displacement - cycle.train.shape.radius) / MM;
}
