/** The forces on one body, as arrows: from where, how large, on what. */
import { turnedBy } from "./geometry.js";

/** The bodies that one can look at. */
export const BODIES = ["piston", "rod", "crank"];

/** The forces on a body at a sample, in the engine's frame: { name, kind, at: [x, y], force }. With
 * onCrown one is drawn on the piston's crown, with onSkirt below its skirt, with onSide on its side
 * towards Y (1) or away.
 *
 * v : variables; k : number of the cylinder
 */
export function forcesOn(body, train, v, k) {
  if (body === "piston") return onPiston(train, v, k);
  if (body === "rod") return onRod(train, v, k);
  return onCrank(train, v);
}

function onPiston(train, v, k) {
  const { bank } = train.cylinders[k];
  const at = v.cylinders[k];
  const pin = turnedBy(bank, at.piston_position, train.gears[k].shape.offset);
  const place = (x, y) => turnedBy(bank, x, y);
  const found = [
    arrow("wall on piston", "wall", pin, place(0, at.side_force)),
    arrow("rod on piston", "pin", pin, place(at.piston_pin_force_x, at.piston_pin_force_y)),
  ];
  const add = (...about) => found.push(arrow(...about));
  if (train.friction !== null) {
    const onSide = at.side_force > 0 ? -1 : 1;
    add("friction on piston", "bearing", pin, place(-at.friction_force, 0), { onSide });
  }
  const [onCrown, onSkirt] = [true, true];
  if (train.pressure.length) add("gas on piston", "gas", pin, place(-at.gas_force, 0), { onCrown });
  if (train.applies) {
    add("applied force", "outside", pin, place(-at.applied_force, 0), { onSkirt });
  }
  return found;
}

function onRod(train, v, k) {
  const { bank, phase } = train.cylinders[k];
  const at = v.cylinders[k];
  const { radius: r, offset } = train.gears[k].shape;
  const pin = turnedBy(bank, at.piston_position, offset);
  const throwAt = v.crank_angle + phase + bank;
  const crank = [r * Math.cos(throwAt), r * Math.sin(throwAt)];
  const [px, py] = [at.piston_pin_force_x, at.piston_pin_force_y];
  return [
    arrow("piston on rod", "pin", pin, turnedBy(bank, -px, -py)),
    arrow("crank on rod", "bearing", crank,
      turnedBy(bank, at.crank_pin_force_x, at.crank_pin_force_y)),
  ];
}

function onCrank(train, v) {
  const rods = train.cylinders.map(({ bank, phase }, k) => {
    const r = train.gears[k].shape.radius;
    const angle = v.crank_angle + phase + bank;
    const { crank_pin_force_x: x, crank_pin_force_y: y } = v.cylinders[k];
    const name = train.cylinders.length > 1 ? `rod ${k + 1} on crank` : "rod on crank";
    return arrow(name, "pin", [r * Math.cos(angle), r * Math.sin(angle)], turnedBy(bank, -x, -y));
  });
  const bearing = [v.main_bearing_force_x, v.main_bearing_force_y];
  return [...rods, arrow("bearing on crank", "bearing", [0, 0], bearing)];
}

function arrow(name, kind, at, force, where) {
  return { name, kind, at, force, ...where };
}
