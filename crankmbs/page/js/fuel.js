/** Each firing's share of the combustion: where it is decided, and how.
 *
 * A cylinder decides where its compression begins, at the cycle angle of 180 degrees, and at the
 * start; the share holds one period. Fuel is { misfire: [{ cylinder, first, last, every }], after,
 * until, from_speed, until_speed }; governed and scattered firings run in Python alone.
 */
import { wrapped } from "./arrays.js";

const SAME = 1e-8; // rad: decisions so near one another are one

/** Crank angles in one period at which a cylinder decides [rad]; none without fuel. */
export function decisionAngles(fuel, cylinders, period) {
  return fuel === null ? [] : cylinders.map((c) => wrapped(Math.PI - c.phase, period));
}

/** The decisions on the way of a crank that turns in one sense. */
export class Firing {
  constructor(fuel, cylinders, period, start) {
    Object.assign(this, { fuel, cylinders, period, start });
    this.shares = new Float64Array(fuel === null ? 0 : cylinders.length);
    this.made = new Map(); // shares that come again are the same object
    this.setIn = null; // speed at the decision at which the fuel set in
    this.isOver = false;
    if (fuel !== null) this.decide(0, start.speed, cylinders.map(() => 1));
  }

  /** Decide at a crank angle, for the cylinders that do so there; state : gives time and speed. */
  pass(theta, sense, state) {
    if (this.fuel === null || Math.abs(theta - this.start.angle) <= SAME) return;
    const { cylinders, period } = this;
    let cycles = null;
    for (let k = 0; k < cylinders.length; k++) {
      const { phase } = cylinders[k];
      const turns = (theta + phase - Math.PI) / period;
      if (Math.abs(turns - Math.round(turns)) * period >= 2 * SAME) continue;
      cycles ??= cylinders.map(() => 0);
      cycles[k] = this.cycleOf(phase, Math.round(turns), sense);
    }
    if (cycles?.some((cycle) => cycle > 0)) this.decide(...state(), cycles);
  }

  /** How many firing dead centres the cycle that is decided and those since the start hold. */
  cycleOf(phase, decided, sense) {
    const begun = (this.start.angle + phase - 2 * Math.PI) / this.period;
    if (sense > 0) return decided - Math.floor(begun + SAME);
    return Math.ceil(begun - SAME) - decided + 1;
  }

  /** cycles : number of the cycle that each cylinder decides on; 0 where it does not. */
  decide(time, omega, cycles) {
    this.judgeWindow(time, omega);
    const burns = this.setIn !== null && !this.isOver ? 1 : 0;
    const shares = this.shares.map((share, k) => {
      if (cycles[k] === 0) return share;
      return this.fuel.misfire.some((each) => strikes(each, k + 1, cycles[k])) ? 0 : burns;
    });
    const name = String(shares);
    if (!this.made.has(name)) this.made.set(name, shares);
    this.shares = this.made.get(name);
  }

  judgeWindow(time, omega) {
    const { after, until, from_speed: from, until_speed: last } = this.fuel;
    if (until !== null && time >= until) this.isOver = true;
    if (this.setIn === null) {
      const met = from === null || isMet(from, this.start.speed, omega);
      if (met && time >= after) this.setIn = omega;
    } else if (last !== null && isMet(last, this.setIn, omega)) {
      this.isOver = true;
    }
  }
}

/** Whether a speed has been met between two decisions, from either side. */
function isMet(speed, before, now) {
  return (before - speed) * (now - speed) <= 0;
}

/** Whether a misfire strikes a cycle, counted from 1. */
function strikes({ cylinder, first, last, every }, number, cycle) {
  if (cylinder !== number) return false;
  return every ? cycle % first === 0 : first <= cycle && cycle <= last;
}
