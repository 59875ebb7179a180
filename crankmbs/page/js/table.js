/** What `movingAt` gives at many crank angles, in columns. At the nodes of the cells of a period
 * and at samples it is kept, so that a flywheel or a load costs nothing here. */
import { isSame, remembering, wrapped } from "./arrays.js";
import { nodesBetween } from "./rule.js";
import {
  addCylinder, fillMasses, fillPushes, massColumns, pushColumns, rowOf,
} from "./tables.js";

const TURN = 2 * Math.PI;
const SLIVER = 1e-12; // rad: cells whose widths differ by less are of one

class Table {
  /** angles : so many in a cell; all comes again after a period */
  constructor(train, angles, stages, period) {
    Object.assign(this, { angles, length: angles.length });
    Object.assign(this, repeating(train, angles, stages, period));
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
 * and the numbers of the first cylinders with the same masses and with the same push: in cells of
 * one width like cylinders meet the same angles. Else nothing comes again. */
function repeating({ cylinders, gears, pressure, firing }, angles, stages, period) {
  const count = Math.round(period / (angles[stages] - angles[0]));
  const width = period / count;
  const cells = [TURN, ...cylinders.map(({ phase }) => wrapped(phase, period))]
    .map((angle) => angle / width);
  const even = count > 0 && stages * count <= angles.length &&
    cells.every((each) => Math.abs(each - Math.round(each)) < SLIVER / width) &&
    angles.every((each, n) => n < stages || Math.abs(each - angles[n - stages] - width) < SLIVER);
  if (!even) {
    const own = cylinders.map((_, k) => k);
    const [turn, whole] = [angles.length, angles.length];
    return { turn, whole, ahead: own.map(() => 0), heavy: own, like: own };
  }
  const [turn, ...ahead] = cells.map((each) => stages * Math.round(each));
  const heavy = firstLike(cylinders.map(({ own, bank }, k) => [own ? k : null, bank]));
  const like = firstLike(cylinders.map((_, k) => [
    heavy[k], gears[k].applied, ...[pressure[k], firing[k]].flatMap((cycle) =>
      [cycle?.knots, cycle?.coefficients]),
  ]));
  return { turn, whole: stages * count, ahead, heavy, like };
}

/** The numbers of the first that each of some lists is the same as. */
function firstLike(lists) {
  return lists.map((own) => lists.findIndex((each) => isSame(each, own)));
}

/** A maker of a table at crank angles [rad], so many in a cell, which remembers its last; all comes
 * again after a period. */
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
    tables(train, angles(edges, rule), rule.nodes.length, edges[edges.length - 1]);
}
