/** What `movingAt` gives at many crank angles, in columns. At the nodes of the cells of a period
 * and at samples it is kept, so that a flywheel or a load costs nothing here. */
import { isSame, remembering, wrapped } from "./arrays.js";
import { nodesBetween } from "./rule.js";
import { crankWeight, massesAt, pushAt } from "./tables.js";

const TURN = 2 * Math.PI;
const SLIVER = 1e-12; // rad: cells whose widths differ by less are of one
const SUMS = ["inertia", "slope", "torque", "rings", "drag"];
const MASSES = ["x", "x1", "inertia", "slope", "weight"];
const PUSHES = ["torque", "gas", "combustion", "rings", "drag"];

class Table {
  /** angles : so many in a cell; all comes again after a period */
  constructor(train, angles, stages, period) {
    const { crank, cylinders, gravity, friction, pressure, firing } = train;
    this.angles = angles;
    this.length = angles.length;
    Object.assign(this, columns(SUMS, angles.length));
    const each = (there) => (there ? cylinders.map(() => new Float64Array(angles.length)) : []);
    this.gas = each(friction?.ring_pressure && pressure.length);
    this.combustion = each(firing.length);
    this.torque.forEach((_, n) => (this.torque[n] = crankWeight(crank, gravity, angles[n])));
    this.add(train, repeating(train, angles, stages, period));
    this.row = { theta: 0, inertia: 0.5, slope: 0.5, torque: 0.5, rings: 0.5, drag: 0.5 };
    Object.assign(this.row, { combustion: this.combustion.map(() => 0.5) });
    this.row.gas = this.gas.map(() => 0.5);
  }

  /** Add the cylinders; of like ones each place is computed once, of their masses in a turn. */
  add(train, { turn, whole, ahead, heavy, like }) {
    const { angles, gas, combustion } = this;
    const [masses, pushes] = [[], []];
    train.cylinders.forEach(({ phase }, k) => {
      const place = (n) => (n + ahead[k]) % whole;
      const mass = (masses[heavy[k]] ??= columns(MASSES, turn));
      for (let n = 0; heavy[k] === k && n < turn; n++) {
        fillMass(mass, place(n) % turn, massesAt(train, k, angles[n] + phase));
      }
      const push = (pushes[like[k]] ??= columns(PUSHES, whole));
      for (let n = 0; like[k] === k && n < whole; n++) {
        const at = place(n) % turn;
        fillPush(push, place(n), pushAt(train, k, angles[n] + phase, mass.x[at], mass.x1[at]));
      }
      for (let n = 0; n < angles.length; n++) {
        const to = place(n);
        const at = to % turn;
        this.inertia[n] += mass.inertia[at];
        this.slope[n] += mass.slope[at];
        this.torque[n] += mass.weight[at] + push.torque[to];
        this.rings[n] += push.rings[to];
        this.drag[n] += push.drag[to];
        if (gas.length) gas[k][n] = push.gas[to];
        if (combustion.length) combustion[k][n] = push.combustion[to];
      }
    });
  }

  /** The row of number n, until the next is asked for. */
  at(n) {
    const { row, gas, combustion } = this;
    row.theta = this.angles[n];
    row.inertia = this.inertia[n];
    row.slope = this.slope[n];
    row.torque = this.torque[n];
    row.rings = this.rings[n];
    row.drag = this.drag[n];
    for (let k = 0; k < gas.length; k++) row.gas[k] = gas[k][n];
    for (let k = 0; k < combustion.length; k++) row.combustion[k] = combustion[k][n];
    return row;
  }
}

function columns(names, count) {
  return Object.fromEntries(names.map((name) => [name, new Float64Array(count)]));
}

// by name, not in a loop over names, which takes several times as long

function fillMass(to, n, { x, x1, inertia, slope, weight }) {
  to.x[n] = x;
  to.x1[n] = x1;
  to.inertia[n] = inertia;
  to.slope[n] = slope;
  to.weight[n] = weight;
}

function fillPush(to, n, { torque, gas, combustion, rings, drag }) {
  to.torque[n] = torque;
  to.gas[n] = gas;
  to.combustion[n] = combustion;
  to.rings[n] = rings;
  to.drag[n] = drag;
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
