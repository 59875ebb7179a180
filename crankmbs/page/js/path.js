/** A solved motion: cells of the crank angle, and what lies between their edges. */
import { countUpTo } from "./arrays.js";
import { torqueOf, torqueOverAngle } from "./loads.js";
import { integralTo } from "./rule.js";
import { movingAt, unloadedAt } from "./tables.js";

const SAME = 8 * Number.EPSILON; // of a crank angle: rounding, as in crankmbs.motion.cells

/** Solved cells, each from `from` over `width` [rad, signed] on one branch of the loads; torque and
 * slowness at its nodes stand in their arrays from number `first` on. */
export class Path {
  constructor(rule) {
    Object.assign(this, { rule, cells: [], starts: [] });
  }

  add(cell) {
    this.cells.push(cell);
    this.starts.push(cell.sense * cell.from);
  }

  /** The cell of a crank angle; one on an edge, but for rounding, is in that before it. */
  cellAt(theta) {
    const { sense } = this.cells[0];
    let k = countUpTo(this.starts, sense * theta) - 1;
    if (k > 0 && sense * theta - this.starts[k] <= SAME * Math.abs(theta)) k--;
    return this.cells[Math.max(k, 0)];
  }
}

/** Time [s], speed, acceleration [rad/s, rad/s2], torque from outside [N m] and shares of the
 * combustion on a path at a crank angle [rad]; of : `movingAt` there. */
export function readPath(train, path, theta, of = movingAt(train, theta)) {
  const [{ rule }, cell] = [path, path.cellAt(theta)];
  const { from, width, sense, energy, time, first, branch, phases, shares } = cell;
  const x = (theta - from) / width;
  const t = time + Math.abs(width) * integralTo(rule, cell.slowness, first, x);
  const kinetic = energy + width * integralTo(rule, cell.torque, first, x);
  const inertia = train.crank.inertia + of.inertia;
  const omega = sense * Math.sqrt((2 * Math.max(kinetic, 0)) / inertia);
  const load = torqueOf(branch, t, omega);
  const alpha = (unloadedAt(train, of, cell, omega) + load) / inertia;
  const outside = load + torqueOverAngle(train.loads, phases, theta);
  return { time: t, theta, omega, alpha, external_torque: outside, shares };
}
