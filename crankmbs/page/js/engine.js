/** From a scene to its motion: the one place that knows every part.
 *
 * The engine keeps what it made last. A new flywheel, load or speed rebuilds no table; a new mass
 * only sums what the loops have; a new shape, all.
 */
import { recurring, remembering, repeated } from "./arrays.js";
import { knotsOver } from "./cubics.js";
import { settleFree } from "./freed.js";
import { appliedMarks, appliedTo } from "./applied.js";
import { frictionMarks } from "./friction.js";
import { Firing, decisionAngles } from "./fuel.js";
import { Loop, runningGear, shapeOf, topPosition } from "./geometry.js";
import { DIAGRAM, SEEN, pressuresOf } from "./gas.js";
import { Travel } from "./motion.js";
import { readPath } from "./path.js";
import { partsOf } from "./refine.js";
import { settle } from "./settled.js";
import { speedLaw } from "./speed.js";
import { strongOf } from "./strong.js";
import { nodeMaker, tableMaker } from "./table.js";
import { edgesOf, reduceAt, split } from "./tables.js";

const ROUNDS = 8; // of cutting cells
const MOST_CELLS = 20000;
const COARSE = Math.PI / 24; // the widest cell of a quick pass; firings are often as far apart
const SAME = 1e-9; // rad: a decision so near has not been passed

/** rules : of Gauss collocation, by their number of stages. */
export class Engine {
  constructor(rules) {
    this.rules = rules;
    this.nodes = nodeMaker();
    this.finer = nodeMaker();
    this.samples = tableMaker();
    this.shapes = remembering((parts) => parts.map(shapeOf), (parts) =>
      parts.map((each) => Object.values(shapeOf(each))));
    this.loops = remembering((shapes) => shapes.map((shape) => new Loop(shape)));
    this.pressures = remembering(pressuresOf);
    // a stronger load has the knots that it had
    this.marks = remembering(marksOf);
    this.edges = remembering(edgesOf);
    this.bends = remembering(frictionMarks);
    this.kinks = remembering(appliedMarks);
    this.strong = remembering(strongOf);
  }

  /** The crank train of a scene: its machine with the pressures that its shape has. Under `gears`
   * what moves in each cylinder and rubs there; shape, piston: of the first.
   *
   * quick : diagrams of polytropes are fitted to what a screen shows */
  train(scene, quick = false) {
    const { crank, cylinders, levers, throws, gravity, friction, loads, fuel, period } = scene;
    const gears = this.gears(scene);
    const [{ shape, piston }] = gears;
    const share = piston.crank_end_share;
    const { pressure, firing, crank_end } =
      this.pressures(scene.gas, shape, share, quick ? SEEN : DIAGRAM);
    return { // not all of the scene: so many names would be slow to look up
      gears, shape, piston, crank, cylinders, levers, throws, gravity, friction, loads, fuel,
      period, pressure, firing, crank_end, applies: scene.force.length > 0,
    };
  }

  /** What moves in every cylinder, with the forces from outside on its piston. */
  gears({ friction, force, ...machine }) {
    const parts = runningGear(machine);
    const shapes = this.shapes(parts);
    const loops = this.loops(shapes);
    return parts.map(({ radius, rod, piston }, k) => {
      const applied = appliedTo(force, k);
      const drag = applied.reduce((sum, { viscous }) => sum + viscous, friction?.viscous ?? 0);
      const top = topPosition(shapes[k]);
      const [shape, loop] = [shapes[k], loops[k]];
      return { radius, rod, piston, shape, loop, top, applied, drag };
    });
  }

  /** The motion of a scene; its cells are cut until they err by no more than a tolerance, relative,
   * per radian. With none it is quick: cells pass over knots at which hardly anything bends, and
   * are taken as they are. */
  run(scene, { stages = 5, tolerance = null, warm = null } = {}) {
    const quick = tolerance === null;
    const train = this.train(scene, quick);
    let edges = this.edgesFor(train, scene.grid_period, quick);
    if (scene.motion !== null) return new Prescribed(train, scene.motion, edges, scene.run);
    for (let round = 0; ; round++) {
      const grid = this.grid(train, edges, stages, this.nodes);
      const motion = this.pass(scene, train, grid, warm);
      if (quick || round >= ROUNDS || edges.length > MOST_CELLS) return motion;
      if (motion.ending !== "complete") return motion;
      const finer = this.grid(train, edges, stages + 2, this.finer);
      const parts = partsOf(train, motion.grid, finer, motion.path, tolerance);
      if (parts.every((each) => each === 1)) return motion;
      edges = split(edges, parts);
    }
  }

  edgesFor(train, period, quick) {
    const { gears, cylinders, pressure, firing, loads, fuel } = train;
    const shapes = gears.map(({ shape }) => shape);
    const tables = loads.map((load) => load.over_angle).filter((cycle) => cycle !== null);
    const decisions = decisionAngles(fuel, cylinders, train.period);
    const knots = (quick ? strongOf(tables) : tables).map((cycle) => cycle.knots);
    const marks = this.marks(knots, decisions, train.period, period);
    const cycles = [...pressure, ...firing];
    const cut = quick ? this.strong(cycles) : cycles;
    const bends = this.bends(train.friction, shapes, cylinders, cycles, period);
    const applied = gears.map((gear) => gear.applied);
    const kinks = this.kinks(applied, shapes, cylinders, period, quick);
    const drags = gears.some(({ drag }) => drag > 0); // which may brake hard within a cell
    const widest = quick && !drags ? COARSE : undefined;
    return this.edges(shapes, cylinders, cut, [...marks, bends, kinks], period, widest);
  }

  grid(train, edges, stages, maker) {
    const rule = this.rules[stages];
    return { edges, rule, nodes: maker(train, edges, rule) };
  }

  pass(scene, train, grid, warm) {
    const { start, run } = scene;
    if (scene.freed) return new Settled(grid, start, settleFree(train, grid, start));
    if (run.settled) return new Settled(grid, start, settle(train, grid, start, warm));
    const { inertia } = reduceAt(train, start.angle);
    const sense = start.speed < 0 ? -1 : 1;
    const energy = 0.5 * inertia * start.speed * start.speed;
    const begin = { theta: start.angle, time: 0, energy, sense };
    const theta = run.in_time ? sense * Infinity : start.angle + sense * run.until;
    const stop = { theta, time: run.in_time ? run.until : Infinity };
    return new Free(train, grid, new Travel(train, grid, begin, stop));
  }
}

/** Crank angles [rad] at which loads over the angle have knots and the fuel is decided. */
function marksOf(knots, decisions, own, period) {
  const over = knots.map((each) => knotsOver({ knots: each }, 0, period));
  return [repeated(decisions, period, own), ...over];
}

/** A free motion from its start to its end. */
class Free {
  constructor(train, grid, { path, ending, start, theta }) {
    Object.assign(this, { train, grid, path, ending, from: start.angle, to: theta });
  }

  /** The sample at a crank angle [rad] between `from` and `to`; of : `movingAt` there. */
  at(theta, of) {
    return readPath(this.train, this.path, theta, of);
  }

  /** Crank angles from one to another between which all is smooth. */
  smoothBetween(from, to) {
    return inside(this.path.cells.map((cell) => cell.from), from, to);
  }
}

/** A settled motion, over a period from its start. */
class Settled {
  constructor(grid, start, { train, ending, motion, factor, balanced, theta, sense, period }) {
    Object.assign(this, { train, grid, ending, factor, balanced, sense, period });
    if (ending !== "complete") return;
    Object.assign(this, { path: motion.path, base: theta, duration: motion.time, late: 0 });
    Object.assign(this, { from: start.angle, to: start.angle + sense * period });
    this.late = this.at(start.angle).time;
  }

  /** The sample at any crank angle [rad], time from the start's angle on; of : as above. */
  at(theta, of) {
    const { train, period, sense, base, path } = this;
    const turns = Math.floor((sense * (theta - base)) / period);
    const within = theta - sense * turns * period;
    const found = readPath(train, path, within, of);
    found.theta = theta;
    found.time += turns * this.duration - this.late;
    return found;
  }

  /** Crank angles from one to another between which all is smooth. */
  smoothBetween(from, to) {
    const own = this.path.cells.map((cell) => cell.from);
    return inside(recurring(own, this.period, from, to), from, to);
  }
}

/** One angle, those that lie between, in order, and the other. */
function inside(angles, from, to) {
  const sense = to < from ? -1 : 1;
  const between = angles.filter((each) => sense * (each - from) > 0 && sense * (to - each) > 0);
  return [from, ...between.sort((a, b) => sense * (a - b)), to];
}

/** A prescribed motion: nothing has to be integrated. */
class Prescribed {
  constructor(train, motion, edges, run) {
    Object.assign(this, { train, edges, ending: "complete" });
    this.law = speedLaw(motion);
    const [, omega] = this.law.at(0);
    this.sense = omega < 0 ? -1 : 1;
    this.from = motion.angle;
    this.to = run.in_time ? this.law.at(run.until)[0] : this.from + this.sense * run.until;
    this.shares = this.decisions({ angle: motion.angle, speed: omega });
  }

  /** The shares of the combustion from each crank angle on at which some are decided. */
  decisions(start) {
    const { train, sense } = this;
    const firing = new Firing(train.fuel, train.cylinders, train.period, start);
    const found = [{ theta: this.from, shares: firing.shares }];
    if (train.fuel === null) return found;
    for (const theta of this.smoothBetween(this.from, this.to).slice(1)) {
      firing.pass(theta, sense, () => {
        const time = this.law.timeAt(theta);
        return [time, this.law.at(time)[1]];
      });
      found.push({ theta, shares: firing.shares });
    }
    return found;
  }

  /** The sample at a crank angle [rad]; at a decision with the shares before it. */
  at(theta) {
    const { sense, shares: all } = this;
    const time = this.law.timeAt(theta);
    const [, omega, alpha] = this.law.at(time);
    let k = all.length - 1;
    while (k > 0 && sense * (theta - all[k].theta) <= SAME) k--;
    return { time, theta, omega, alpha, external_torque: null, shares: all[k].shares };
  }

  /** Crank angles from one to another between which all is smooth. */
  smoothBetween(from, to) {
    const { edges, law } = this;
    const own = recurring(edges.slice(1), edges[edges.length - 1], from, to);
    return inside([...own, ...law.bendsBetween(from, to)], from, to);
  }
}
