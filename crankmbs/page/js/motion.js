/** One free rotation that does not reverse, with the crank angle as the variable.
 *
 * The kinetic energy E = J omega^2 / 2 obeys dE/dtheta = Q, the torque of gas, weights and loads;
 * time follows from dt/dtheta = 1 / omega. Gauss collocation solves cell after cell, between edges
 * that are the knots of pressures and loads over the angle. Where a load bends or jumps in time or
 * speed the motion lands on the kink and goes on from there in a new cell.
 */
import { AffineCells, areAffine } from "./affine.js";
import { Sum, countUpTo, rootIn, wrapped } from "./arrays.js";
import { Stepper } from "./cell.js";
import { Firing } from "./fuel.js";
import { branchAt, firstPhases, laterPhases, torqueOf } from "./loads.js";
import { Path } from "./path.js";
import { reduceAt, unloadedAt } from "./tables.js";

const SLIVER = 1e-12; // rad
const LANDINGS = 12;
const GRAZES = 16; // places in a cell at which a speed is looked at that comes near a kink

/** A motion on its way from a state, cell by cell.
 *
 * grid : { edges, nodes, rule }; begin : { theta, time, energy, sense }; stop : { theta, time }
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
    this.atNodes = { first: Infinity }; // torque and slowness of as many cells as a period has
    this.stepper = new Stepper(grid.rule);
    this.factor = 1;
    [this.energies, this.times] = [new Sum(this.energy), new Sum(this.time)];
    this.stuck = 0;
    this.ending = null;
    if (this.enter(omega)) this.go();
  }

  /** Take the branch of the loads that the motion enters; whether there is one. */
  enter(omega) {
    const { train, time, phases } = this;
    this.branch = branchAt(train.loads, phases, time, omega, this.unloaded(omega));
    if (this.branch === null) {
      this.ending = "held";
      return false;
    }
    this.branch.tEnd = Math.min(this.branch.tEnd, this.stop.time);
    // cells by the shares of the combustion
    this.affine = areAffine(train, this.branch, this.sense) ? new Map() : null;
    return true;
  }

  go() {
    const { edges } = this.grid;
    const n = edges.length - 1;
    const period = edges[n];
    const turn = Math.floor((this.theta + this.sense * SLIVER) / period);
    let k = countUpTo(edges, this.theta + this.sense * SLIVER - turn * period) - 1;
    for (; this.ending === null; k += this.sense) {
      this.toEdge(turn + Math.floor(k / n), wrapped(k, n));
    }
  }

  /** Through cell k of a period, across all kinks in it, to its other edge or the end. */
  toEdge(turn, k) {
    const { edges } = this.grid;
    const base = turn * edges[edges.length - 1];
    const low = base + edges[k];
    const high = base + edges[k + 1];
    const edge = this.sense > 0 ? high : low;
    const last = this.sense * (this.stop.theta - edge) <= SLIVER;
    const target = last ? this.stop.theta : edge;
    if (!last && this.sense * (target - this.theta) <= SLIVER) return;
    const short = high - low - Math.abs(target - this.theta);
    const whole = target === edge && Math.abs(short) < SLIVER;
    if (!whole) this.pass(target, -1);
    else if (!this.follow(target, k)) {
      this.stepper.take(this, k);
      this.pass(target, k);
    }
    while (this.ending === null && this.theta !== target) this.pass(target, -1);
    if (this.ending !== null) return;
    if (last) this.ending = "complete";
    else if (this.train.fuel !== null) this.decide();
  }

  decide() {
    const { train, theta, sense, energy, time } = this;
    this.firing.pass(theta, sense, () =>
      [time, sense * Math.sqrt((2 * energy) / reduceAt(train, theta).inertia)]);
  }

  /** Through whole cell k without solving it, if it is affine and its branch holds up to its end;
   * whether so. */
  follow(target, k) {
    const { affine, firing: { shares }, energy, time, branch } = this;
    if (affine === null) return false;
    if (!affine.has(shares)) affine.set(shares, new AffineCells(this, branch, shares));
    const cells = affine.get(shares);
    const { torque, slowness, first } = this.room();
    const spent = cells.pass(k, energy, torque, slowness, first);
    if (time + spent >= branch.tEnd) return false;
    const growth = cells.growth[k];
    const gained = growth * energy + cells.rise[k];
    if (!(energy + gained > 0) || cells.isSlow) this.ending = "slow";
    else this.accept(target, k, { gained, spent, growth });
    return true;
  }

  /** To an angle, or the first kink on the way; number : of the cell, if it is a whole one. */
  pass(target, number) {
    const { stepper } = this;
    const width = target - this.theta;
    if (number < 0) stepper.tabulate(this, target);
    if (!stepper.solve(this, width) || stepper.isSlow()) {
      this.ending = "slow";
      return;
    }
    const exit = this.exit(width);
    if (exit === null) this.accept(target, number, stepper.passed(width, this.room()));
    else this.land(target, exit);
  }

  /** Add a cell, of which torque and slowness are in their room, and go on to its end. */
  accept(target, number, { gained, spent, growth }) {
    const { theta, energy, time, sense, branch, phases, firing: { shares } } = this;
    const { torque, slowness, first } = this.atNodes;
    this.path.add({
      from: theta, width: target - theta, energy, time, sense,
      branch, phases, shares, number, torque, slowness, first,
    });
    this.atNodes.first += this.grid.rule.nodes.length;
    this.energies.add(gained);
    this.times.add(spent);
    this.energy = this.energies.value;
    this.time = this.times.value;
    this.factor *= 1 + growth;
    this.theta = target;
    this.stuck = 0;
  }

  /** Where torque and slowness of the next cell go. */
  room() {
    const { length } = this.grid.nodes;
    if (this.atNodes.first >= length) {
      const [torque, slowness] = [new Float64Array(length), new Float64Array(length)];
      this.atNodes = { torque, slowness, first: 0 };
    }
    return this.atNodes;
  }

  /** Where in the solved cell, from 0 to 1, the branch ends first, and by what; null if nowhere. */
  exit(width) {
    const { branch, stepper, sense, time } = this;
    const timely = time + Math.abs(width) * stepper.spent >= branch.tEnd;
    const met = (limit) => Number.isFinite(limit) && limit * sense > 0;
    if (!timely && !met(branch.low) && !met(branch.high)) return null;
    let first = null;
    if (timely) {
      const late = (x) => time + Math.abs(width) * stepper.spentTo(x) - branch.tEnd;
      first = { x: rootIn(late, 0, 1), time: branch.tEnd, omega: null };
    }
    for (const [limit, side] of [[branch.low, -1], [branch.high, 1]]) {
      if (!met(limit) || !stepper.mayLeave(limit, sense)) continue;
      const beyond = (x) => side * (this.speedIn(width, x) - limit);
      const x = firstAbove(beyond, stepper.places);
      if (x !== null && !(first?.x <= x)) first = { x, time: null, omega: limit };
    }
    return first;
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
    if (Math.abs(width) > SLIVER) {
      this.accept(this.theta + width, -1, stepper.passed(width, this.room()));
    } else if (++this.stuck > 3) this.ending = "held";
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
    const alpha = (this.unloaded(speed, of) + torqueOf(this.branch, t, speed)) / of.inertia;
    return ((omega - speed) * speed) / alpha;
  }

  /** On a kink: exactly there, in the phases and on the branch that begin. */
  arrive({ time, omega }) {
    const { inertia } = reduceAt(this.train, this.theta);
    if (time !== null) this.time = time;
    if (omega !== null) this.energy = 0.5 * inertia * omega * omega;
    [this.energies, this.times] = [new Sum(this.energy), new Sum(this.time)];
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
    return this.unloaded(omega) + torqueOf(this.branch, this.time, omega);
  }

  /** The same without the loads over time and speed; of : the crank train where the motion is. */
  unloaded(omega, of = reduceAt(this.train, this.theta)) {
    const { train, phases, sense, firing: { shares } } = this;
    return unloadedAt(train, of, { shares, phases, sense }, omega);
  }
}

/** The first place, from 0 to 1, where a function rises above 0: between neighbouring places, or
 * between more of them. */
function firstAbove(f, places) {
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
