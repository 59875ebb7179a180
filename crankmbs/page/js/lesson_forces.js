/** Forces and side thrust: gas against inertia, and what a rod of two masses misses. */
import { KN, readable } from "./format.js";
import { begun } from "./lesson.js";
import { drawn } from "./quantities.js";
import { overAngle, sizeOf } from "./shapes.js";

const TWO_MASSES = "untruncated lecture";

export function start() {
  return begun({ along: ALONG, side: SIDE, worth: WORTH });
}

const ALONG = {
  shapes: (cycle) => {
    const inertia = inertiaOf(cycle);
    const gas = (v) => v.cylinders[0].gas_force / KN;
    const curves = [
      { name: "sum", of: (v) => gas(v) + inertia(v) },
      { name: "gas", style: "exact", of: gas },
      { name: "inertia", style: "second", of: inertia },
    ];
    return [overAngle(cycle, { title: "force towards the crank", unit: "kN", curves })];
  },
  says: (cycle) => {
    const inertia = inertiaOf(cycle);
    const most = cycle.samples.reduce((best, v) =>
      (v.cylinders[0].gas_force > best.cylinders[0].gas_force ? v : best));
    return {
      gas: `${readable(most.cylinders[0].gas_force / KN, 1)} kN`,
      inertia: `${readable(inertia(most), 1)} kN`,
    };
  },
};

const SIDE = {
  scene: (turner, { share, ...values }) => {
    const scene = turner.scene(values);
    return { ...scene, rod: { ...scene.rod, inertia: share * twoMasses(scene.rod) } };
  },
  shapes: (cycle) => {
    const said = cycle.lectured(TWO_MASSES);
    const lectured = said.map((each) => each.cylinders[0]["side thrust"] / KN);
    const curves = [
      { name: "rigid rod", of: (v) => v.cylinders[0].side_force / KN },
      { name: "two masses", style: "exact", y: lectured },
    ];
    const apart = [["two masses − rigid rod", 1, 0]];
    const most = (0.4 * twoMasses(cycle.scene.rod) * swingOf(cycle)) / KN;
    return [overAngle(cycle, {
      title: "side thrust of the wall", unit: "kN", curves, apart, holdsBelow: [-most, most],
    })];
  },
  says: (cycle) => {
    const says = cycle.lectured(TWO_MASSES);
    const off = cycle.samples.map((v, n) =>
      Math.abs(says[n].cylinders[0]["side thrust"] - v.cylinders[0].side_force));
    return { off: `${readable(Math.max(...off), 0)} N` };
  },
};

const WORTH = {
  shapes: (cycle, { quantity }) => [drawn(quantity, cycle, 0)],
  says: (cycle, { quantity }) => {
    const { curves, differences } = drawn(quantity, cycle, 0);
    const peak = sizeOf([curves[0].y]);
    const [masses, series] = differences.map(({ y }) =>
      `${readable((100 * sizeOf([y])) / peak, 2)} %`);
    return { masses, series };
  },
};

/** The inertia force of all that goes to and fro, towards the crank [kN]. */
function inertiaOf({ scene: { rod, piston } }) {
  const mass = piston.mass + (rod.mass * rod.center_of_mass) / rod.length;
  return (v) => (-mass * v.cylinders[0].piston_acceleration) / KN;
}

/** The inertia that two masses at the pins have about the rod's centre [kg m2]. */
function twoMasses({ mass, center_of_mass: center, length }) {
  return mass * center * (length - center);
}

/** What a rod's hardest swing makes of its inertia at the wall [N per kg m2]. */
function swingOf({ mean, train: { shape } }) {
  const cosine = Math.sqrt(1 - ((shape.radius + Math.abs(shape.offset)) / shape.length) ** 2);
  return ((shape.radius / shape.length) * mean ** 2) / cosine ** 2 / shape.length;
}
