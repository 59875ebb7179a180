/** Gauss collocation in one cell of the crank angle: Newton's method on energies at its nodes. */
import { torqueOf } from "./loads.js";
import { LinearCell, eachNode, integralTo } from "./rule.js";
import { givenAt, movingAt } from "./tables.js";

export const SLOW = Math.PI / 360; // rad: within which no energy may be gone, or it is refused
const SETTLED = 1e-15; // relative change of the energy in Newton's last step
const GOOD = 1e-11;
const NEWTON = 30;

/** The cell that is being solved: what is at its nodes, and what comes of it. */
export class Stepper {
  constructor(rule) {
    const s = rule.nodes.length;
    this.rule = rule;
    this.places = [0, ...rule.nodes, 1];
    const names = ["inertia", "given", "energy", "torque", "slowness", "rate", "drag", "push"];
    for (const name of names) this[name] = new Float64Array(s);
    this.linear = new LinearCell(rule);
    this.work = this.spent = 0;
  }

  /** Take a whole cell of the grid. */
  take(motion, number) {
    eachNode(motion.grid, number, motion.sense, (of, j) => this.load(motion, of, j));
  }

  /** Take what the crank train is at node j of those that are passed, as `movingAt` gives it. */
  load({ train, phases, firing: { shares }, sense }, of, j) {
    this.inertia[j] = train.crank.inertia + of.inertia;
    this.given[j] = givenAt(train, of, { shares, phases, sense }, 0);
    this.drag[j] = of.drag;
  }

  /** The same of a cell from where a motion is to an angle. */
  tabulate(motion, target) {
    const { train, theta } = motion;
    this.rule.nodes.forEach((node, j) =>
      this.load(motion, movingAt(train, theta + (target - theta) * node), j));
  }

  /** Solve the cell of a signed width from a motion's state on; whether that converges. */
  solve({ energy: begin, time, sense, branch }, width) {
    const { rule, energy, slowness, torque } = this;
    if (!this.iterate(begin, time, sense, branch, width)) return false;
    this.evaluate(branch, time, sense, width);
    this.work = this.spent = 0;
    for (let j = 0; j < energy.length; j++) {
      this.work += rule.weights[j] * torque[j];
      this.spent += rule.weights[j] * slowness[j];
    }
    return begin + width * this.work > 0;
  }

  /** Newton's method on the energies; whether it converges. */
  iterate(begin, time, sense, branch, width) {
    const { rule, given, inertia, energy } = this;
    const s = given.length;
    const first = sense * Math.sqrt((2 * begin) / inertia[0]);
    const load = torqueOf(branch, time, first);
    for (let j = 0; j < s; j++) {
      energy[j] = begin;
      for (let i = 0; i < s; i++) energy[j] += width * rule.matrix[j * s + i] * (given[i] + load);
    }
    let change = Infinity;
    for (let n = 0; n < NEWTON; n++) {
      const before = change;
      this.evaluate(branch, time, sense, width);
      change = this.correct(begin, width);
      if (!(change < Infinity)) return false;
      if (change <= SETTLED || (change < GOOD && change > 0.5 * before)) break;
    }
    return change < GOOD;
  }

  /** Slowness, torque and its rate of change with the energy, at the energies of the nodes. */
  evaluate(branch, time, sense, width) {
    const { rule, given, inertia, energy, slowness, torque, rate, drag } = this;
    const s = given.length;
    for (let j = 0; j < s; j++) {
      slowness[j] = energy[j] > 0 ? Math.sqrt((0.5 * inertia[j]) / energy[j]) : NaN;
    }
    for (let j = 0; j < s; j++) {
      const omega = sense / slowness[j];
      let t = time;
      if (branch.ct !== 0) {
        for (let i = 0; i < s; i++) t += Math.abs(width) * rule.matrix[j * s + i] * slowness[i];
      }
      torque[j] = given[j] + torqueOf(branch, t, omega) - drag[j] * omega;
      rate[j] = (branch.c1 + 2 * branch.c2 * omega - drag[j]) / (inertia[j] * omega);
    }
  }

  /** One step of Newton's method; the relative change of the energies. */
  correct(begin, width) {
    const { energy, torque, rate, push, linear } = this;
    for (let j = 0; j < energy.length; j++) push[j] = torque[j] - rate[j] * energy[j];
    const found = linear.solve(width, push, rate);
    let change = 0;
    for (let j = 0; j < energy.length; j++) {
      const next = found[2 * j] * begin + found[2 * j + 1];
      change += Math.abs(next / energy[j] - 1);
      energy[j] = next;
    }
    return change;
  }

  /** Write torque and slowness of the solved cell from number `first` on; what it gains and takes,
   * and by what part a small difference of the energy grows in it. */
  passed(width, { torque, slowness, first }) {
    const { rule, rate, linear: { found } } = this;
    torque.set(this.torque, first);
    slowness.set(this.slowness, first);
    let growth = 0;
    for (let j = 0; j < rate.length; j++) {
      growth += width * rule.weights[j] * rate[j] * found[2 * j];
    }
    return { gained: width * this.work, spent: Math.abs(width) * this.spent, growth };
  }

  /** Whether the energy would be gone within half a degree. */
  isSlow() {
    const { energy, torque, given } = this;
    for (let j = 0; j < energy.length; j++) {
      const load = Math.abs(torque[j] - given[j]);
      if (energy[j] <= SLOW * (Math.abs(given[j]) + load)) return true;
    }
    return false;
  }

  /** Whether the speed may reach a limit in the cell, as its spread at the nodes tells. */
  mayLeave(limit, sense) {
    const speeds = this.slowness.map((each) => sense / each);
    const [low, high] = [Math.min(...speeds), Math.max(...speeds)];
    const spread = 2 * (high - low);
    return limit >= low - spread && limit <= high + spread;
  }

  workTo(x) {
    return integralTo(this.rule, this.torque, 0, x);
  }

  spentTo(x) {
    return integralTo(this.rule, this.slowness, 0, x);
  }
}
