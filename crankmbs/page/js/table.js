/** What `movingAt` gives at many crank angles, in columns. At the nodes of the cells of a period
 * and at samples it is kept, so that a flywheel or a load costs nothing here. */
import { countUpTo, isSame, remembering, wrapped } from "./arrays.js";
import { nodesBetween } from "./rule.js";
import {
  addCylinder, fillMasses, fillPushes, massColumns, pushColumns, rowOf,
} from "./tables.js";

const TURN = 2 * Math.PI;
const SLIVER = 1e-12; // rad: angles closer than this are one

class Table {
  /** All comes again after a period. */
  constructor(train, angles, period) {
    Object.assign(this, { angles, length: angles.length }, repeating(train, angles, period));
    const { turn, whole, ahead, heavy, like } = this;
    this.weight = angles.slice(0, turn).map((theta) => rowOf(train, theta).torque);
    this.row = rowOf(train, angles[0]);
    const [masses, pushes] = [[], []];
    // of like cylinders each place is computed once, of their masses in a turn
    train.cylinders.forEach(({ phase }, k) => {
      const place = (n) => (n + ahead[k]) % whole;
      masses[k] = masses[heavy[k]] ?? massColumns(turn);
      for (let n = 0; heavy[k] === k && n < turn; n++) {
        fillMasses(train, k, angles[n] + phase, masses[k], place(n) % turn);
      }
      pushes[k] = pushes[like[k]] ?? pushColumns(whole, masses[k]);
      for (let n = 0; like[k] === k && n < whole; n++) {
        fillPushes(train, k, angles[n] + phase, pushes[k], place(n));
      }
    });
    this.pushes = pushes;
  }

  /** The row of number n, until the next is asked for. */
  at(n) {
    const { row, pushes, ahead, turn, whole } = this;
    row.theta = this.angles[n];
    row.torque = this.weight[n % turn];
    row.inertia = row.slope = row.rings = row.drag = 0;
    for (let k = 0; k < pushes.length; k++) addCylinder(row, k, pushes[k], (n + ahead[k]) % whole);
    return row;
  }
}

/** After how many angles the masses and all else come again, by how many each cylinder is ahead,
 * and the numbers of the first cylinders with the same masses and with the same push: where like
 * cylinders meet the same angles. Else nothing comes again. */
function repeating({ cylinders, gears, pressure, firing }, angles, period) {
  const { length } = angles;
  const whole = countUpTo(angles, angles[0] + period - SLIVER);
  const steps = [TURN, ...cylinders.map(({ phase }) => wrapped(phase, period))];
  const [turn, ...ahead] = steps.map((far) => stepOf(angles, whole, period, far));
  if (turn === null || ahead.includes(null)) {
    const own = cylinders.map((_, k) => k);
    return { turn: length, whole: length, ahead: own.map(() => 0), heavy: own, like: own };
  }
  const heavy = firstLike(cylinders.map(({ own, bank }, k) => [own ? k : null, bank]));
  const like = firstLike(cylinders.map((_, k) => [
    heavy[k], gears[k].applied, ...[pressure[k], firing[k]].flatMap((cycle) =>
      [cycle?.knots, cycle?.coefficients]),
  ]));
  return { turn, whole, ahead, heavy, like };
}

/** How many angles on all of them come again by so much farther; null where they do not. */
function stepOf(angles, whole, period, far) {
  const step = countUpTo(angles, angles[0] + far - SLIVER);
  for (let n = 0, to = step, turned = 0; n < angles.length; n++, to++) {
    if (to === whole) [to, turned] = [0, turned + period];
    if (!(Math.abs(angles[to] + turned - angles[n] - far) < SLIVER)) return null;
  }
  return step;
}

/** The numbers of the first that each of some lists is the same as. */
function firstLike(lists) {
  return lists.map((own) => lists.findIndex((each) => isSame(each, own)));
}

/** A maker of a table at crank angles [rad], which remembers its last; all comes again after a
 * period. */
export function tableMaker() {
  return remembering((...about) => new Table(...about), (train, angles) => {
    const { crank, gears, cylinders, gravity, friction, pressure, firing } = train;
    const parts = gears.map(({ shape, rod, piston, drag, applied }) => [
      shape, rod.mass, rod.center_of_mass, rod.inertia, piston.mass, piston.area, drag, applied,
    ]);
    const first = crank.mass * crank.center_of_mass;
    return [angles, parts, cylinders, first, gravity, friction, pressure, firing];
  });
}

/** The same at the nodes of the cells of a period. */
export function nodeMaker() {
  const angles = remembering(nodesBetween);
  const tables = tableMaker();
  return (train, edges, rule) =>
    tables(train, angles(edges, rule), edges[edges.length - 1]);
}
