/** The forces on one body, as arrows: from where, how large, on what. */
import { turnedBy } from "./geometry.js";

/** The bodies that one can look at. */
export const BODIES = ["piston", "rod", "crank"];

/** The forces on a body, of variables v each { name, kind, at(v): [x, y] in the engine's frame, and
 * x(v), y(v) [N] in one that leans by `bank` }. With onCrown it is drawn on the piston's crown,
 * with onSkirt below its skirt, with onSide(v) on its side towards Y (1) or away.
 *
 * k : number of the cylinder
 */
export function forcesOn(body, train, k) {
  if (body === "piston") return onPiston(train, k);
  return body === "rod" ? onRod(train, k) : onCrank(train);
}

/** One of them in the engine's frame [N]. */
export function forceAt({ bank, x, y }, v) {
  return turnedBy(bank, x(v), y(v));
}

function onPiston(train, k) {
  const [pin, of] = [pistonPin(train, k), variables(k)];
  const found = [
    arrow("wall on piston", "wall", pin, [none, of("side_force")]),
    arrow("rod on piston", "pin", pin, [of("piston_pin_force_x"), of("piston_pin_force_y")]),
  ];
  const add = (name, kind, resists, where) =>
    found.push(arrow(name, kind, pin, [of(resists, -1), none], where));
  if (train.friction !== null) {
    const onSide = (v) => (v.cylinders[k].side_force > 0 ? -1 : 1);
    add("friction on piston", "bearing", "friction_force", { onSide });
  }
  if (train.pressure.length) add("gas on piston", "gas", "gas_force", { onCrown: true });
  if (train.applies) add("applied force", "outside", "applied_force", { onSkirt: true });
  return found;
}

function onRod(train, k) {
  const [pin, crank, of] = [pistonPin(train, k), crankPin(train, k), variables(k)];
  const pushed = [of("piston_pin_force_x", -1), of("piston_pin_force_y", -1)];
  return [
    arrow("piston on rod", "pin", pin, pushed),
    arrow("crank on rod", "bearing", crank, [of("crank_pin_force_x"), of("crank_pin_force_y")]),
  ];
}

function onCrank(train) {
  const rods = train.cylinders.map((_, k, { length: count }) => {
    const of = variables(k);
    const name = count > 1 ? `rod ${k + 1} on crank` : "rod on crank";
    const pushed = [of("crank_pin_force_x", -1), of("crank_pin_force_y", -1)];
    return arrow(name, "pin", crankPin(train, k), pushed);
  });
  const held = [(v) => v.main_bearing_force_x, (v) => v.main_bearing_force_y];
  return [...rods, arrow("bearing on crank", "bearing", { bank: 0, at: () => [0, 0] }, held)];
}

function arrow(name, kind, place, [x, y], where) {
  return { name, kind, ...place, x, y, ...where };
}

/** What reads a variable of a cylinder by its name, times a sign. */
function variables(k) {
  return (name, sign = 1) => (v) => sign * v.cylinders[k][name];
}

function none() {
  return 0;
}

function pistonPin({ cylinders, gears }, k) {
  const { bank } = cylinders[k];
  const { offset } = gears[k].shape;
  return { bank, at: (v) => turnedBy(bank, v.cylinders[k].piston_position, offset) };
}

function crankPin({ cylinders, gears }, k) {
  const { phase, bank } = cylinders[k];
  const { radius } = gears[k].shape;
  return { bank, at: (v) => turnedBy(v.crank_angle + phase + bank, radius, 0) };
}
