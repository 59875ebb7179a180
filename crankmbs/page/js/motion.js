/** One free rotation that does not reverse, with the crank angle as the variable.
 *
 * The kinetic energy E = J omega^2 / 2 obeys dE/dtheta = Q, the torque of gas, weights and loads;
 * time follows from dt/dtheta = 1 / omega. Gauss collocation solves cell after cell, between edges
 * that are the knots of pressures and loads over the angle. Where a load bends or jumps in time or
 * speed the motion lands on the kink and goes on from there in a new cell.
 */
import { countUpTo, eliminate } from "./arrays.js";
import { branchAt, firstPhases, laterPhases, torqueOf, torqueOverAngle } from "./loads.js";
import { Firing } from "./fuel.js";
import { integralTo } from "./rule.js";
import { reduceAt } from "./tables.js";

const SLOW = Math.PI / 360; // rad: where the energy would be gone within this angle, it is refused
const SLIVER = 1e-12; // rad
const SETTLED = 1e-15; // relative change of the energy in Newton's last step
const GOOD = 1e-11;
const NEWTON = 30;
const LANDINGS = 12;
const GRAZES = 16; // places in a cell at which a speed is looked at that comes near a kink

/** Solved cells, each from `from` over `width` [rad, signed] on one branch of the loads. */
export class Path {
  constructor(rule) {
    this.rule = rule;
    this.cells = [];
    this.starts = [];
  }

  add(cell) {
    this.cells.push(cell);
    this.starts.push(cell.sense * cell.from);
  }

  /** The cell in which a crank angle lies; one on an edge is in that before it. */
  cellAt(theta) {
    const { sense } = this.cells[0];
    let k = countUpTo(this.starts, sense * theta) - 1;
    if (k > 0 && this.starts[k] === sense * theta) k--;
    return this.cells[Math.max(k, 0)];
  }

  /** Time [s], speed, acceleration [rad/s, rad/s2], torque from outside [N m] and shares of the
   * combustion at a crank angle [rad]. */
  at(train, theta) {
    return readCell(train, this.rule, this.cellAt(theta), theta);
  }
}

/** What `Path.at` gives, in a cell. */
export function readCell(train, rule, cell, theta) {
  const { from, width, sense, energy, time, torque, slowness, branch, phases, shares } = cell;
  const x = (theta - from) / width;
  const t = time + Math.abs(width) * integralTo(rule, slowness, 0, x);
  const kinetic = energy + width * integralTo(rule, torque, 0, x);
  const of = reduceAt(train, theta);
  const omega = sense * Math.sqrt((2 * Math.max(kinetic, 0)) / of.inertia);
  const outside = torqueOf(branch, t, omega) + torqueOverAngle(train.loads, phases, theta);
  const given = of.torque + burnt(of.combustion, shares);
  const alpha = (given + outside - 0.5 * of.slope * omega * omega) / of.inertia;
  return { time: t, theta, omega, alpha, external_torque: outside, shares };
}

function burnt(combustion, shares) {
  return combustion.reduce((sum, each, k) => sum + shares[k] * each, 0);
}

/** A motion on its way from a state, cell by cell.
 *
 * grid : { edges, tables, rule }; begin : { theta, time, energy, sense }; stop : { theta, time }
 * ending : "complete", "slow" where the crank comes near rest, "held" where a jump of a load holds
 * its speed; factor : by which a small difference of the energy has grown
 */
export class Travel {
  constructor(train, grid, begin, stop) {
    Object.assign(this, { train, grid, stop, ...begin });
    const { inertia } = reduceAt(train, this.theta);
    const omega = this.sense * Math.sqrt((2 * this.energy) / inertia);
    this.start = { angle: this.theta, speed: omega };
    this.phases = firstPhases(train.loads, omega);
    this.firing = new Firing(train.fuel, train.cylinders, train.period, this.start);
    this.path = new Path(grid.rule);
    this.stepper = new Stepper(grid.rule);
    this.factor = 1;
    this.lost = 0; // of the energy and the time by rounding
    this.late = 0;
    this.stuck = 0;
    this.ending = null;
    if (this.enter(omega)) this.go();
  }

  /** Take the branch of the loads that the motion enters; whether there is one. */
  enter(omega) {
    const { train, theta, time, phases } = this;
    const of = reduceAt(train, theta);
    const given = of.torque + burnt(of.combustion, this.firing.shares);
    const rest = given + torqueOverAngle(train.loads, phases, theta) - 0.5 * of.slope * omega ** 2;
    this.branch = branchAt(train.loads, phases, time, omega, rest);
    if (this.branch === null) {
      this.ending = "held";
      return false;
    }
    this.branch.tEnd = Math.min(this.branch.tEnd, this.stop.time);
    return true;
  }

  go() {
    const { edges } = this.grid;
    const n = edges.length - 1;
    const period = edges[n];
    let turn = Math.floor((this.theta + this.sense * SLIVER) / period);
    let k = countUpTo(edges, this.theta + this.sense * SLIVER - turn * period) - 1;
    if (k === n) [turn, k] = [turn + 1, 0];
    while (this.ending === null) {
      this.toEdge(turn, k);
      k += this.sense;
      if (k === n) [turn, k] = [turn + 1, 0];
      if (k < 0) [turn, k] = [turn - 1, n - 1];
    }
  }

  /** Through cell k of a period, across all kinks in it, to its other edge or the end. */
  toEdge(turn, k) {
    const { edges } = this.grid;
    const base = turn * edges[edges.length - 1];
    const [low, high] = [base + edges[k], base + edges[k + 1]];
    const edge = this.sense > 0 ? high : low;
    const last = this.sense * (this.stop.theta - edge) <= SLIVER;
    const target = last ? this.stop.theta : edge;
    if (!last && this.sense * (target - this.theta) <= SLIVER) return;
    const whole = target === edge && Math.abs(Math.abs(target - this.theta) - (high - low)) < SLIVER;
    if (whole) this.stepper.load(this, this.grid, k, this.sense);
    this.pass(target, whole ? k : -1);
    while (this.ending === null && this.theta !== target) this.pass(target, -1);
    if (this.ending !== null) return;
    if (last) this.ending = "complete";
    else if (this.train.fuel !== null) this.decide();
  }

  decide() {
    const { inertia } = reduceAt(this.train, this.theta);
    const omega = this.sense * Math.sqrt((2 * this.energy) / inertia);
    this.firing.pass(this.time, this.theta, omega, this.sense);
  }

  /** To an angle, or to the first kink on the way there; number of the cell if it is a whole one. */
  pass(target, number) {
    const { stepper } = this;
    if (number < 0) stepper.tabulate(this, target);
    if (!stepper.solve(this, target - this.theta) || stepper.isSlow()) {
      this.ending = "slow";
      return;
    }
    const exit = this.exit(target - this.theta);
    if (exit === null) this.accept(target, number);
    else this.land(target, exit);
  }

  /** Add the solved cell and go on to its end. */
  accept(target, number) {
    const { stepper, energy, time } = this;
    const width = target - this.theta;
    const { sense, branch, phases } = this;
    const at = { from: this.theta, width, energy, time, sense, branch, phases, number };
    this.path.add({ ...at, ...stepper.nodes(), shares: this.firing.shares });
    const gained = width * stepper.work - this.lost;
    this.energy = energy + gained;
    this.lost = this.energy - energy - gained;
    const spent = Math.abs(width) * stepper.spent - this.late;
    this.time = time + spent;
    this.late = this.time - time - spent;
    this.factor *= 1 + stepper.growth(width);
    this.theta = target;
    this.stuck = 0;
  }

  /** Where in the solved cell, from 0 to 1, the branch ends first, and by what; null if nowhere. */
  exit(width) {
    const { branch, stepper, sense, time } = this;
    const exits = [];
    if (time + Math.abs(width) * stepper.spent >= branch.tEnd) {
      const late = (x) => time + Math.abs(width) * stepper.spentTo(x) - branch.tEnd;
      exits.push({ x: rootIn(late, 0, 1), time: branch.tEnd, omega: null });
    }
    for (const [limit, side] of [[branch.low, -1], [branch.high, 1]]) {
      if (!Number.isFinite(limit) || limit * sense <= 0) continue;
      const beyond = (x) => side * (this.speedIn(width, x) - limit);
      const x = firstAbove(beyond, stepper.places, stepper.mayLeave(limit, sense));
      if (x !== null) exits.push({ x, time: null, omega: limit });
    }
    return exits.reduce((first, one) => (first === null || one.x < first.x ? one : first), null);
  }

  /** Speed [rad/s] at a place of the solved cell. */
  speedIn(width, x) {
    const { inertia } = reduceAt(this.train, this.theta + x * width);
    const energy = this.energy + width * this.stepper.workTo(x);
    return this.sense * Math.sqrt((2 * Math.max(energy, 0)) / inertia);
  }

  /** Solve again up to the kink, by Newton's method, and go on from there on the next branch. */
  land(target, exit) {
    const { stepper } = this;
    const whole = target - this.theta;
    let width = exit.x * whole;
    for (let n = 0; n < LANDINGS && Math.abs(width) > SLIVER; n++) {
      stepper.tabulate(this, this.theta + width);
      if (!stepper.solve(this, width)) break;
      const step = this.missing(exit, width);
      if (Math.abs(step) <= 1e-15 * Math.max(1, Math.abs(this.theta))) break;
      const next = width + step;
      width = next / whole > 0 ? next : 0.5 * width;
    }
    if (Math.abs(width) > SLIVER) this.accept(this.theta + width, -1);
    else if (++this.stuck > 3) this.ending = "held";
    if (this.ending === null) this.arrive(exit);
  }

  /** By how much wider [rad] the solved cell must be to end on the kink. */
  missing({ time, omega }, width) {
    const { stepper } = this;
    const at = this.theta + width;
    const end = this.energy + width * stepper.work;
    const of = reduceAt(this.train, at);
    const speed = this.sense * Math.sqrt((2 * end) / of.inertia);
    const t = this.time + Math.abs(width) * stepper.spent;
    if (time !== null) return speed * (time - t);
    const given = of.torque + burnt(of.combustion, this.firing.shares);
    const outside = torqueOf(this.branch, t, speed);
    const over = torqueOverAngle(this.train.loads, this.phases, at);
    const alpha = (given + outside + over - 0.5 * of.slope * speed * speed) / of.inertia;
    return ((omega - speed) * speed) / alpha;
  }

  /** On a kink: exactly there, in the phases and on the branch that begin. */
  arrive({ time, omega }) {
    const { inertia } = reduceAt(this.train, this.theta);
    if (time !== null) this.time = time;
    if (omega !== null) this.energy = 0.5 * inertia * omega * omega;
    this.lost = this.late = 0;
    if (time !== null && time >= this.stop.time) {
      this.ending = "complete";
      return;
    }
    const speed = omega ?? this.sense * Math.sqrt((2 * this.energy) / inertia);
    const before = this.accelerated(speed);
    this.phases = laterPhases(this.train.loads, this.phases, this.time, speed);
    // where the torque jumps a difference of energies is passed on by the ratio of accelerations
    if (this.enter(speed) && omega !== null && before !== 0) {
      this.factor *= this.accelerated(speed) / before;
    }
  }

  /** Acceleration times inertia [N m] at the state, on the present branch. */
  accelerated(omega) {
    const { train, theta, time, branch, phases } = this;
    const of = reduceAt(train, theta);
    const given = of.torque + burnt(of.combustion, this.firing.shares);
    const outside = torqueOf(branch, time, omega) + torqueOverAngle(train.loads, phases, theta);
    return given + outside - 0.5 * of.slope * omega * omega;
  }
}

/** A root of a function that is below 0 at one place and not below at a later one. */
function rootIn(f, low, high) {
  if (f(low) >= 0) return low;
  for (let n = 0; n < 60 && high - low > 1e-16; n++) {
    const middle = 0.5 * (low + high);
    if (f(middle) >= 0) high = middle;
    else low = middle;
  }
  return high;
}

/** The first place, from 0 to 1, where a function rises above 0: between neighbouring places, or,
 * where it comes near, between more of them. */
function firstAbove(f, places, near) {
  if (!near) return null;
  let before = 0;
  for (let k = 1; k < places.length; k++) {
    for (let part = 1; part <= GRAZES; part++) {
      const x = places[k - 1] + ((places[k] - places[k - 1]) * part) / GRAZES;
      if (f(x) > 0) return rootIn(f, before, x);
      before = x;
    }
  }
  return null;
}

/** Gauss collocation in one cell: Newton's method on the energies at its nodes. */
class Stepper {
  constructor(rule) {
    const s = rule.nodes.length;
    this.rule = rule;
    this.places = [0, ...rule.nodes, 1];
    for (const name of ["inertia", "given", "energy", "torque", "slowness", "rate"]) {
      this[name] = new Float64Array(s);
    }
    this.right = new Float64Array(s);
    this.system = new Float64Array(s * s);
    this.work = this.spent = 0;
  }

  /** Inertia and torque over the angle at the nodes of a whole cell, from the tables. */
  load({ train, phases, firing }, { tables }, number, sense) {
    const s = this.given.length;
    const { shares } = firing;
    for (let j = 0; j < s; j++) {
      const i = number * s + (sense > 0 ? j : s - 1 - j);
      this.inertia[j] = train.crank.inertia + tables.inertia[i];
      let given = tables.torque[i] + torqueOverAngle(train.loads, phases, tables.angles[i]);
      for (let c = 0; c < shares.length; c++) given += shares[c] * tables.combustion[c][i];
      this.given[j] = given;
    }
  }

  /** The same from where a motion is to an angle. */
  tabulate({ train, phases, firing, theta }, target) {
    this.rule.nodes.forEach((node, j) => {
      const angle = theta + (target - theta) * node;
      const of = reduceAt(train, angle);
      this.inertia[j] = of.inertia;
      this.given[j] = of.torque + burnt(of.combustion, firing.shares);
      this.given[j] += torqueOverAngle(train.loads, phases, angle);
    });
  }

  /** Solve the cell of a signed width from a motion's state on; whether that converges. */
  solve({ energy: begin, time, sense, branch }, width) {
    const { rule, given, inertia, energy, slowness, torque } = this;
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
    if (!(change < GOOD)) return false;
    this.evaluate(branch, time, sense, width);
    this.work = this.spent = 0;
    for (let j = 0; j < s; j++) {
      this.work += rule.weights[j] * torque[j];
      this.spent += rule.weights[j] * slowness[j];
    }
    return begin + width * this.work > 0;
  }

  /** Slowness, torque and its rate of change with the energy, at the energies of the nodes. */
  evaluate(branch, time, sense, width) {
    const { rule, given, inertia, energy, slowness, torque, rate } = this;
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
      torque[j] = given[j] + torqueOf(branch, t, omega);
      rate[j] = (branch.c1 + 2 * branch.c2 * omega) / (inertia[j] * omega);
    }
  }

  /** One step of Newton's method; the relative change of the energies. */
  correct(begin, width) {
    const { rule, energy, torque, rate, right, system } = this;
    const s = energy.length;
    for (let j = 0; j < s; j++) {
      right[j] = begin;
      for (let i = 0; i < s; i++) {
        const step = width * rule.matrix[j * s + i];
        right[j] += step * (torque[i] - rate[i] * energy[i]);
        system[j * s + i] = (i === j ? 1 : 0) - step * rate[i];
      }
    }
    eliminate(system, right, s, 1);
    let change = 0;
    for (let j = 0; j < s; j++) {
      change += Math.abs(right[j] / energy[j] - 1);
      energy[j] = right[j];
    }
    return change;
  }

  /** By what part a small difference of the energy grows in the solved cell. */
  growth(width) {
    const { rule, rate, right, system } = this;
    const s = rate.length;
    for (let j = 0; j < s; j++) {
      right[j] = 1;
      for (let i = 0; i < s; i++) {
        system[j * s + i] = (i === j ? 1 : 0) - width * rule.matrix[j * s + i] * rate[i];
      }
    }
    eliminate(system, right, s, 1);
    let grown = 0;
    for (let j = 0; j < s; j++) grown += width * rule.weights[j] * rate[j] * right[j];
    return grown;
  }

  /** Whether the energy would be gone within half a degree. */
  isSlow() {
    return this.energy.some((each, j) => {
      const load = Math.abs(this.torque[j] - this.given[j]);
      return each <= SLOW * (Math.abs(this.given[j]) + load);
    });
  }

  /** Whether the speed may reach a limit in the cell, as its spread at the nodes tells. */
  mayLeave(limit, sense) {
    let low = Infinity;
    let high = -Infinity;
    for (const slowness of this.slowness) {
      low = Math.min(low, sense / slowness);
      high = Math.max(high, sense / slowness);
    }
    const spread = 2 * (high - low);
    return limit >= low - spread && limit <= high + spread;
  }

  workTo(x) {
    return integralTo(this.rule, this.torque, 0, x);
  }

  spentTo(x) {
    return integralTo(this.rule, this.slowness, 0, x);
  }

  nodes() {
    return { torque: this.torque.slice(), slowness: this.slowness.slice() };
  }
}

