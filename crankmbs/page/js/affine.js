/** Cells under loads of c0 + c2 omega^2: dE/dtheta = push + rate E.
 *
 * Of the energy E at a cell's begin it makes gain E + shift at each node, and E + (growth E + rise)
 * at its end. None of this depends on E: a cell that is met again needs no solving, and the maps of
 * cells are composed to that of a period, of which the motion is one sweep from its fixed point.
 */
import { Sum } from "./arrays.js";
import { SLOW } from "./cell.js";
import { isAffine } from "./loads.js";
import { Path } from "./path.js";
import { LinearCell, eachNode } from "./rule.js";
import { givenAt } from "./tables.js";

/** Whether every cell is affine under a branch of the loads, at whatever speed in this sense. */
export function areAffine({ gears }, branch, sense) {
  const ends = (limit) => sense * limit > 0 && Number.isFinite(limit);
  const drags = gears.some(({ drag }) => drag > 0);
  return isAffine(branch) && !drags && !ends(branch.low) && !ends(branch.high);
}

/** The cells of a period, by their numbers, each solved when it is first met. */
export class AffineCells {
  /** motion : { train, grid, sense, phases }; shares : of the combustion */
  constructor({ train, grid, sense, phases }, branch, shares) {
    Object.assign(this, { train, grid, branch, state: { shares, phases, sense } });
    const { edges, rule } = grid;
    const [count, s] = [edges.length - 1, rule.nodes.length];
    for (const name of ["inertia", "push", "rate", "gain", "shift"]) {
      this[name] = new Float64Array(count * s);
    }
    this.growth = new Float64Array(count).fill(NaN); // until it is solved
    this.rise = new Float64Array(count);
    this.linear = new LinearCell(rule);
    [this.slope, this.least, this.most] = [0, Infinity, 0];
  }

  /** Signed width of a cell [rad]. */
  width(number) {
    const { grid: { edges }, state: { sense } } = this;
    return sense * (edges[number + 1] - edges[number]);
  }

  /** Inertia, push and rate at the nodes, in the sense of rotation, and the maps of a cell. */
  solve(number) {
    const { train, grid, branch, state, inertia, push, rate, gain, shift } = this;
    const { weights } = grid.rule;
    const s = weights.length;
    const first = number * s;
    const width = this.width(number);
    eachNode(grid, number, state.sense, (of, j) => {
      inertia[first + j] = train.crank.inertia + of.inertia;
      push[first + j] = givenAt(train, of, state, 0) + branch.c0;
      rate[first + j] = (2 * branch.c2) / inertia[first + j];
    });
    const found = this.linear.solve(width, push, rate, first);
    let growth = 0;
    let rise = 0;
    for (let j = 0; j < s; j++) {
      const at = first + j;
      gain[at] = found[2 * j];
      shift[at] = found[2 * j + 1];
      growth += width * weights[j] * rate[at] * gain[at];
      rise += width * weights[j] * (push[at] + rate[at] * shift[at]);
    }
    this.growth[number] = growth;
    this.rise[number] = rise;
  }

  /** Pass a cell from an energy [J] on: torque and slowness at its nodes are written from number
   * `to` on. The time that it takes [s], NaN where the energy is gone; `slope` is how that changes
   * with the energy, `least` and `most` that at all nodes so far, `isSlow` whether at a node of the
   * cell it would be gone within half a degree. */
  pass(number, energy, torque, slowness, to) {
    if (Number.isNaN(this.growth[number])) this.solve(number);
    const { inertia, push, rate, gain, shift, branch: { c0 }, grid: { rule: { weights } } } = this;
    let spent = 0;
    let slope = 0;
    this.isSlow = false;
    for (let j = 0, k = number * weights.length; j < weights.length; j++, k++) {
      const kinetic = gain[k] * energy + shift[k];
      const part = 0.5 / kinetic;
      const slow = Math.sqrt(inertia[k] * part); // NaN where it is gone
      torque[to + j] = push[k] + rate[k] * kinetic;
      slowness[to + j] = slow;
      spent += weights[j] * slow;
      slope -= weights[j] * slow * gain[k] * part;
      const load = Math.abs(c0 + rate[k] * kinetic);
      if (!(kinetic > SLOW * (Math.abs(push[k] - c0) + load))) this.isSlow = true;
      if (kinetic < this.least) this.least = kinetic;
      if (kinetic > this.most) this.most = kinetic;
    }
    const width = Math.abs(this.width(number));
    this.slope = width * slope;
    return width * spent;
  }
}

/** A period of such cells, in the order in which they are passed.
 *
 * section : { train, grid, theta, sense, phases, first }, first being the number of the first cell
 */
export class AffinePeriod {
  constructor(section, branch) {
    this.section = section;
    this.cells = new AffineCells(section, branch, new Float64Array(0));
    const count = section.grid.edges.length - 1;
    this.numbers = Array.from({ length: count }, (_, c) =>
      (section.first + count + (section.sense > 0 ? c : -1 - c)) % count);
    for (const number of this.numbers) this.cells.solve(number);
    this.compose();
  }

  /** Crank angle [rad] at which a cell begins; no sum of widths, which would round. */
  from(number) {
    const { grid: { edges }, sense, theta, first } = this.section;
    const ahead = sense > 0 ? edges[number] - edges[first] : edges[first] - edges[number + 1];
    return theta + sense * (ahead < 0 ? ahead + edges[edges.length - 1] : ahead);
  }

  /** The map of the whole period, { growth, rise }: E becomes E + (growth E + rise). */
  compose() {
    const { numbers, cells } = this;
    const after = new Float64Array(numbers.length);
    let growth = 0;
    for (const number of numbers) {
      const own = cells.growth[number];
      growth += own + growth * own;
      after[number] = growth;
    }
    // the cells' rises nearly cancel in a steady motion: each times what the rest makes of it
    const total = new Sum();
    for (const number of numbers) {
      total.add(cells.rise[number] * ((1 + growth) / (1 + after[number])));
    }
    this.whole = { growth, rise: total.value };
  }

  /** The largest torque over the angle with that of the load at rest [N m]. */
  largest() {
    const { push, branch: { c0 } } = this.cells;
    return push.reduce((most, each) => Math.max(most, Math.abs(each - c0)), 0) + Math.abs(c0);
  }

  /** The motion that begins with an energy [J]: its path, duration [s], least and greatest energy,
   * and how the duration changes with the energy that it begins with. */
  sweep(energy) {
    const { section: { grid, sense, phases }, cells, numbers } = this;
    const { branch, state: { shares } } = cells;
    const { length } = grid.nodes;
    const [torque, slowness] = [new Float64Array(length), new Float64Array(length)];
    const path = new Path(grid.rule);
    const [at, time] = [new Sum(energy), new Sum()];
    let [grown, slope] = [1, 0];
    [cells.least, cells.most] = [Infinity, 0];
    for (const number of numbers) {
      const [begin, first] = [at.value, number * grid.rule.nodes.length];
      path.add({
        from: this.from(number), width: cells.width(number), energy: begin, time: time.value, sense,
        branch, phases, shares, number, torque, slowness, first,
      });
      time.add(cells.pass(number, begin, torque, slowness, first));
      at.add(cells.growth[number] * begin + cells.rise[number]);
      slope += cells.slope * grown;
      grown *= 1 + cells.growth[number];
    }
    const { least, most } = cells;
    return { path, time: time.value, least, most, slope };
  }
}
