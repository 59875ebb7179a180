/** Why the speed is not constant: from the turning moment over the energy to the speed. */
import { RPM, readable } from "./format.js";
import { begun } from "./lesson.js";
import { overAngle } from "./shapes.js";

export function start() {
  return begun({ moment: MOMENT, energy: ENERGY, speed: SPEED });
}

const MOMENT = {
  shapes: (cycle) => {
    const { inertia } = cycle.scene.crank;
    const torques = [
      { name: "gas", of: gasTorque },
      { name: "load", style: "exact", of: (v) => -v.external_torque },
      {
        name: "load, pistons and rods",
        style: "second",
        of: (v) => gasTorque(v) - inertia * v.crank_acceleration,
      },
    ];
    const speeds = [
      { name: "crank speed", of: (v) => v.crank_speed / RPM },
      { name: "its mean", style: "plain", of: () => cycle.mean / RPM },
    ];
    return [
      overAngle(cycle, { title: "torque", unit: "N m", curves: torques }),
      overAngle(cycle, { title: "crank speed", unit: "rpm", curves: speeds }),
    ];
  },
  says: (cycle) => {
    const load = mean(cycle, (v) => -v.external_torque);
    const most = Math.max(...cycle.samples.map(gasTorque));
    const surplus = cycle.samples.filter((v) => gasTorque(v) > -v.external_torque);
    const faster = surplus.filter((v) => v.crank_acceleration * cycle.sense > 0);
    const share = (100 * faster.length) / surplus.length;
    return {
      mean: `${readable(cycle.mean / RPM, 0)} rpm`,
      load: `${readable(load, 1)} N m`,
      most: `${readable(most, 0)} N m`,
      share: `${readable(share, 0)} %`,
      verdict: share > 50
        ? "pistons and rods take little, and the crank follows the gas"
        : "pistons and rods take more than the surplus, and the crank slows down where they do",
    };
  },
};

const ENERGY = {
  shapes: (cycle) => {
    const middle = mean(cycle, (v) => v.kinetic_energy);
    const curves = [
      { name: "kinetic energy", of: (v) => v.kinetic_energy },
      { name: "its mean", style: "plain", of: () => middle },
    ];
    return [overAngle(cycle, { title: "kinetic energy", unit: "J", curves, holds: { y: [0] } })];
  },
  says: (cycle) => {
    const values = cycle.samples.map((v) => v.kinetic_energy);
    return {
      swing: `${readable(Math.max(...values) - Math.min(...values), 0)} J`,
      stored: `${readable(mean(cycle, (v) => v.kinetic_energy), 0)} J`,
    };
  },
};

const SPEED = {
  shapes: (cycle) => {
    const inertia = mean(cycle, inertiaOf);
    const curves = [
      { name: "simulated", of: (v) => v.crank_speed / RPM },
      {
        name: "as if J were constant",
        style: "exact",
        of: (v) => (cycle.sense * Math.sqrt((2 * v.kinetic_energy) / inertia)) / RPM,
      },
    ];
    const apart = [["simulated − constant J", 0, 1]];
    return [overAngle(cycle, { title: "crank speed", unit: "rpm", curves, apart })];
  },
  says: (cycle) => {
    const inertias = cycle.samples.map(inertiaOf);
    return {
      least: `${readable(Math.min(...inertias), 4)} kg m²`,
      most: `${readable(Math.max(...inertias), 4)} kg m²`,
      delta: `${readable(100 * cycle.fluctuation, 2)} %`,
    };
  },
};

/** The work that the gas does on all pistons per radian of the crank [N m]. */
function gasTorque(v) {
  const power = v.cylinders.reduce((sum, each) => sum + each.gas_force * each.piston_velocity, 0);
  return power / v.crank_speed;
}

/** The inertia of everything that moves, as the crank feels it [kg m2]. */
function inertiaOf(v) {
  return (2 * v.kinetic_energy) / v.crank_speed ** 2;
}

/** The mean over the angle of a cycle. */
function mean({ samples }, of) {
  return samples.slice(1).reduce((sum, v) => sum + of(v), 0) / (samples.length - 1);
}
