/** The scene that the knobs give. What stays at its value stays the same object, so that the engine
 * rebuilds only what depends on what was turned.
 */
import { remembering } from "./arrays.js";
import { MM, RPM, filled } from "./format.js";
import { setFree } from "./freed.js";
import { runningGear, shapeOf, strokeOf } from "./geometry.js";
import { Refused } from "./refused.js";

const PERCENT = 0.01;
const SPARE = 1e-3; // of the stroke, over which the ends of rows over the travel are held

/** Turns the knobs of one scene.
 *
 * given : { scene, knobs, two_mass, orders, sentences } as Python passes them
 */
export class Turner {
  constructor(given) {
    this.given = given;
    this.own = Object.fromEntries(given.knobs.map(({ name, value }) => [name, value]));
    this.cylinders = remembering((order) => evenly(order, given.scene.period));
    this.gas = remembering(pressed);
  }

  /** The scene at values of the knobs, by name; those left out are the scene's own. */
  scene(values) {
    const { scene, sentences } = this.given;
    const at = { ...this.own, ...values };
    const crank = { ...scene.crank };
    if ("flywheel" in values) crank.inertia = at.flywheel;
    if ("counterweight" in values) crank.center_of_mass = at.counterweight * MM;
    const rod = this.rod(at, values);
    const piston = { ...scene.piston };
    if ("offset" in values) piston.offset = at.offset * MM;
    const cylinders = this.layout(values);
    const gears = runningGear({ crank, rod, piston, cylinders });
    for (const gear of gears) refuseOpenLoop(gear, sentences);
    refuseLightCrank(crank, sentences);
    refuseUncovered(scene.force, gears, sentences);
    const shares = gears.map((gear) => gear.piston.crank_end_share);
    const gas = this.gas(scene.gas, at.pressure * PERCENT, shares);
    const [levers, throws] =
      cylinders === scene.cylinders ? [scene.levers, scene.throws] : [null, null];
    const parts = { crank, rod, piston, cylinders, levers, throws, gas };
    const turned = { ...scene, ...parts, ...this.driven(at, values) };
    if (scene.motion === null || values.speed_is !== "free") return turned;
    refuseNoInertia(crank, gears, sentences);
    return setFree(turned);
  }

  /** With another ratio the rod keeps its mass, the place of its centre of mass and its shape; with
   * another mass its shape. */
  rod(at, values) {
    const { scene: { rod, crank }, two_mass: lumped } = this.given;
    const length = "rod_ratio" in values ? crank.radius / at.rod_ratio : rod.length;
    const stretch = length / rod.length;
    const center = rod.center_of_mass * stretch;
    const mass = "rod_mass" in values ? at.rod_mass : rod.mass;
    const kind = values.rod ?? (lumped ? "two-mass" : "rigid");
    let inertia = rod.inertia * (rod.mass > 0 ? mass / rod.mass : 1) * stretch ** 2;
    if (kind === "two-mass") inertia = mass * center * (length - center);
    else if (lumped || (rod.mass === 0 && mass > 0)) inertia = (mass * length ** 2) / 12;
    return { length, mass, center_of_mass: center, inertia };
  }

  layout(values) {
    const { scene, orders } = this.given;
    const own = values.cylinders === undefined;
    return own ? scene.cylinders : this.cylinders(orders[values.cylinders]);
  }

  /** Start, speed and loads: more cylinders share the load evenly, a faster crank has the same
   * torque at its new speed. */
  driven(at, values) {
    const { scene } = this.given;
    const faster = "speed" in values ? at.speed / this.own.speed : 1;
    const prescribed = values.speed_is === "prescribed";
    if (scene.motion !== null) return { motion: sped(scene.motion, at, faster) };
    const start = { ...scene.start };
    if ("speed" in values) start.speed = at.speed * RPM;
    if (prescribed) {
      const run = { ...scene.run, until: scene.period, in_time: false, settled: false };
      return { start: null, motion: constantSpeed(start), loads: [], run };
    }
    const more = this.layout(values).length / scene.cylinders.length;
    const share = more * ("load" in values ? at.load * PERCENT : 1);
    return { start, loads: scene.loads.map((load) => scaledLoad(load, share, faster)) };
  }
}

/** The k-th to fire lags k period / n. */
function evenly(order, period) {
  const n = order.length;
  return order.map((_, number) => {
    const lag = order.indexOf(number + 1);
    return { phase: (((n - lag) % n) * period) / n, bank: 0, own: null };
  });
}

function refuseOpenLoop({ radius, rod, piston }, sentences) {
  const least = radius + Math.abs(piston.offset);
  if (rod.length < least * (1 - 1e-15)) {
    throw new Refused(filled(sentences.open_loop, { least, came: rod.length }));
  }
  if (rod.length <= least) throw new Refused(sentences.fold);
}

function refuseLightCrank({ inertia, mass, center_of_mass: center }, sentences) {
  const least = mass * center ** 2;
  if (inertia < least * (1 - 1e-12)) {
    throw new Refused(filled(sentences.light_crank, { least, came: inertia }));
  }
}

/** A free crank that nothing resists at the dead centres. */
function refuseNoInertia(crank, gears, sentences) {
  const turns = gears.some(({ rod }) =>
    rod.inertia > 0 || (rod.mass > 0 && rod.center_of_mass !== rod.length));
  if (crank.inertia === 0 && !turns) throw new Refused(sentences.no_inertia);
}

/** A force over a travel that is longer than its rows. */
function refuseUncovered(force, gears, sentences) {
  force.forEach(({ rows, cylinder }, number) => {
    if (rows === null) return;
    const on = cylinder === null ? gears : [gears[cylinder - 1]];
    const stroke = Math.max(...on.map((gear) => strokeOf(shapeOf(gear))));
    const [low, high] = [rows[0], rows[rows.length - 1]];
    if (low <= SPARE * stroke && high >= (1 - SPARE) * stroke) return;
    const found = { stroke: stroke / MM, low: low / MM, high: high / MM };
    throw new Refused(filled(sentences.uncovered[number], found));
  });
}

/** The pressures of tables or diagrams times a factor, for cylinders with these shares of the
 * piston's area on the side of the crank; ambient stays. */
function pressed(gas, factor, shares) {
  if (gas === null) return null;
  const same = shares.length === gas.pressure.length;
  if (factor === 1 && same) return gas;
  const every = (list) => (same || !list.length ? list : shares.map(() => list[0]));
  const gauge = gas.ambient * (factor - 1);
  // of what both ends are less ambient
  const across = (k) => gauge * (gas.crank_end.length ? 1 - shares[k] : 1);
  return {
    ...gas,
    pressure: every(gas.pressure.map((cycle, k) => scaledCycle(cycle, factor, across(k)))),
    firing: every(gas.firing.map((cycle, k) => scaledCycle(cycle, factor, across(k)))),
    crank_end: every(gas.crank_end.map((cycle) => scaledCycle(cycle, factor, gauge))),
    sources: gas.sources.map((source) => scaledSource(source, factor, gauge)),
    fired: every(gas.fired),
    below: every(gas.below),
    motored: gas.motored && every(gas.motored),
  };
}

function scaledCycle({ knots, coefficients }, factor, gauge) {
  const n = knots.length - 1;
  return { knots, coefficients: coefficients.map((c, k) => factor * c + (k < 3 * n ? 0 : gauge)) };
}

function scaledSource(source, factor, gauge) {
  const found = { ...source };
  for (const name of ["intake_pressure", "exhaust_pressure", "peak_pressure"]) {
    if (typeof source[name] === "number") found[name] *= factor;
  }
  if (source.kind === "rows") found.value = source.value.map((p) => factor * p + gauge);
  if (source.kind === "constant") found.value = factor * source.value + gauge;
  return found;
}

function sped(motion, { speed }, faster) {
  if (faster === 1) return motion;
  if (motion.kind === "oscillation") {
    return { ...motion, mean: speed * RPM, amplitude: motion.amplitude * Math.abs(faster) };
  }
  return constantSpeed({ angle: motion.angle, speed: speed * RPM });
}

function constantSpeed({ angle, speed }) {
  const knots = Float64Array.of(0, Infinity);
  return { kind: "polynomial", angle, knots, coefficients: Float64Array.of(0, 0, 0, speed) };
}

function scaledLoad(load, share, faster) {
  if (share === 1 && faster === 1) return load;
  const { over_time: time, over_speed: speed, over_angle: angle } = load;
  const times = (values, factors) =>
    values.map((value, k) => share * value * factors[k % factors.length]);
  return {
    ...load,
    over_time: time && { knots: time.knots, pieces: times(time.pieces, [1]) },
    over_speed: speed && {
      knots: speed.knots.map((knot) => faster * knot),
      pieces: times(speed.pieces, [1, 1 / faster, 1 / faster ** 2]),
    },
    over_angle: angle && { knots: angle.knots, coefficients: times(angle.coefficients, [1]) },
    from_speed: load.from_speed && faster * load.from_speed,
    until_speed: load.until_speed && faster * load.until_speed,
  };
}
