/** A period under loads of c0 + c2 omega^2: dE/dtheta = push + rate E in every cell.
 *
 * Of the energy E at a cell's begin it makes gain E + shift at each node, and E + (growth E + rise)
 * at its end. None of this depends on E: the maps of the cells are composed to that of the period,
 * and once its fixed point is known the motion is one sweep without any solving.
 */
import { Sum, eliminate } from "./arrays.js";
import { Path } from "./path.js";
import { eachNode, fillSystem } from "./rule.js";
import { givenAt } from "./tables.js";

/** The maps of the cells of a period, in the order in which they are passed.
 *
 * section : { train, grid, theta, sense, phases, first }, first being the number of the first cell
 */
export class AffinePeriod {
  constructor(section, branch) {
    Object.assign(this, { section, branch });
    const { edges, rule } = section.grid;
    this.stages = rule.nodes.length;
    this.count = edges.length - 1;
    for (const name of ["inertia", "push", "rate", "gain", "shift"]) {
      this[name] = new Float64Array(this.count * this.stages);
    }
    for (const name of ["number", "growth", "rise"]) this[name] = new Float64Array(this.count);
    this.fill();
    this.solve();
    this.compose();
  }

  /** Inertia, push and rate at the nodes, in the sense of rotation. */
  fill() {
    const { section, branch, stages: s, count } = this;
    const { train, grid, sense, phases, first } = section;
    const state = { shares: [], phases, sense };
    for (let c = 0; c < count; c++) {
      const number = (first + count + (sense > 0 ? c : -1 - c)) % count;
      this.number[c] = number;
      eachNode(grid, number, sense, (of, j) => {
        const to = c * s + j;
        this.inertia[to] = train.crank.inertia + of.inertia;
        this.push[to] = givenAt(train, of, state, 0) + branch.c0;
        this.rate[to] = (2 * branch.c2) / this.inertia[to];
      });
    }
  }

  /** Gain and shift at the nodes, growth and rise of every cell. */
  solve() {
    const { section, stages: s, count, push, rate, gain, shift } = this;
    const { matrix, weights } = section.grid.rule;
    const system = new Float64Array(s * s);
    const both = new Float64Array(2 * s);
    for (let c = 0; c < count; c++) {
      const width = this.width(c);
      fillSystem(system, section.grid.rule, width, rate, c * s);
      for (let j = 0; j < s; j++) {
        both[2 * j] = 1;
        both[2 * j + 1] = 0;
        for (let i = 0; i < s; i++) both[2 * j + 1] += width * matrix[j * s + i] * push[c * s + i];
      }
      eliminate(system, both, s, 2);
      for (let j = 0; j < s; j++) {
        const at = c * s + j;
        gain[at] = both[2 * j];
        shift[at] = both[2 * j + 1];
        this.growth[c] += width * weights[j] * rate[at] * gain[at];
        this.rise[c] += width * weights[j] * (push[at] + rate[at] * shift[at]);
      }
    }
  }

  /** Crank angle [rad] at which a cell begins; no sum of widths, which would round. */
  from(c) {
    const { grid, sense, theta, first } = this.section;
    const { edges } = grid;
    const number = this.number[c];
    const ahead = sense > 0 ? edges[number] - edges[first] : edges[first] - edges[number + 1];
    return theta + sense * (ahead < 0 ? ahead + edges[this.count] : ahead);
  }

  /** Signed width of a cell [rad]. */
  width(c) {
    const { edges } = this.section.grid;
    return this.section.sense * (edges[this.number[c] + 1] - edges[this.number[c]]);
  }

  /** The map of the whole period, { growth, rise }: E becomes E + (growth E + rise). */
  compose() {
    const after = new Float64Array(this.count);
    let growth = 0;
    this.growth.forEach((own, c) => {
      growth += own + growth * own;
      after[c] = growth;
    });
    // the cells' rises nearly cancel in a steady motion: each times what the rest makes of it
    const total = new Sum();
    this.rise.forEach((own, c) => total.add(own * ((1 + growth) / (1 + after[c]))));
    this.whole = { growth, rise: total.value };
  }

  /** The motion that begins with an energy [J]: its path, duration [s], least and greatest energy,
   * and how the duration changes with the energy that it begins with. */
  sweep(energy) {
    const { section, branch, stages: s, push, rate, gain, shift, inertia } = this;
    const { grid, sense, phases } = section;
    const { weights } = grid.rule;
    const torque = new Float64Array(push.length);
    const slowness = new Float64Array(push.length);
    const path = new Path(grid.rule);
    const found = { path, least: Infinity, most: 0, slope: 0 };
    const shares = new Float64Array(0);
    const [at, time] = [new Sum(energy), new Sum()];
    let grown = 1;
    for (let c = 0; c < this.count; c++) {
      const width = this.width(c);
      let spent = 0;
      for (let k = c * s; k < (c + 1) * s; k++) {
        const kinetic = gain[k] * at.value + shift[k];
        torque[k] = push[k] + rate[k] * kinetic;
        slowness[k] = kinetic > 0 ? Math.sqrt((0.5 * inertia[k]) / kinetic) : NaN;
        const step = Math.abs(width) * weights[k - c * s] * slowness[k];
        spent += step;
        found.slope -= (0.5 * step * gain[k] * grown) / kinetic;
        found.least = Math.min(found.least, kinetic);
        found.most = Math.max(found.most, kinetic);
      }
      path.add({
        from: this.from(c), width, energy: at.value, time: time.value, sense,
        branch, phases, shares, number: this.number[c], torque, slowness, first: c * s,
      });
      at.add(this.growth[c] * at.value + this.rise[c]);
      time.add(spent);
      grown *= 1 + this.growth[c];
    }
    return { ...found, time: time.value };
  }
}
