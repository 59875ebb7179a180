/** A run between its frames, as the stage takes a cycle: its crank train and where that is. */
import { countUpTo } from "./arrays.js";
import { Loop, runningGear, shapeOf } from "./geometry.js";

export class Track {
  /** given : { scene, time, angle, speed, pressure_time, pressure, fuel, decimals } in SI units,
   * the pressures cylinder by cylinder; decimals : that are shown in s, deg and rpm */
  constructor(given) {
    const { cylinders } = given.scene;
    const gears = runningGear(given.scene).map((part) => {
      const shape = shapeOf(part);
      return { ...part, shape, loop: new Loop(shape) };
    });
    const [begin, end] = [given.time[0], given.time.at(-1)];
    // no ring turns at a mean speed
    Object.assign(this, { given, train: { gears, cylinders }, begin, end, leads: [0] });
    const { pressure_time: times } = given;
    this.samples = Array.from(times.length ? times : [this.begin], (time) => {
      const pressures = this.pressuresAt(time);
      return { cylinders: cylinders.map((_, k) => ({ gas_pressure: pressures(k) })) };
    });
    this.to(this.begin);
  }

  samplesOf() {
    return this.samples;
  }

  /** Go to a time [s]: the motion there. */
  to(time) {
    this.pressures = this.pressuresAt(time);
    return this.motionAt(time);
  }

  /** { angle [rad], speed [rad/s] } at a time [s], by the cubic that has both at the frames beside
   * it. */
  motionAt(time) {
    const { time: at, angle, speed } = this.given;
    const k = cellOf(at, time);
    const h = at[k + 1] - at[k];
    const s = (time - at[k]) / h;
    const rise = (angle[k + 1] - angle[k]) / h;
    const bend = 3 * rise - 2 * speed[k] - speed[k + 1];
    const twist = speed[k] + speed[k + 1] - 2 * rise;
    return {
      angle: angle[k] + h * s * (speed[k] + s * (bend + s * twist)),
      speed: speed[k] + s * (2 * bend + 3 * s * twist),
    };
  }

  /** The time [s] that is shown at another, cut to the digits shown, so that angle and speed can be
   * those at exactly this time. */
  shown(time) {
    const unit = 10 ** this.given.decimals.time;
    return Math.max(Math.floor(time * unit + 1e-6) / unit, this.begin);
  }

  /** The share of the fuel decided last at a time [s]; null before the first decision. */
  fuelAt(time) {
    const { fuel } = this.given;
    const k = fuel ? countUpTo(fuel.time, time) : 0;
    return k ? fuel.share[k - 1] : null;
  }

  /** The crank train at an angle [rad], with the pressures of the time gone to. */
  at(theta) {
    const { gears, cylinders } = this.train;
    return {
      cylinders: cylinders.map(({ phase }, k) => ({
        piston_position: gears[k].loop.at(theta + phase).x,
        gas_pressure: this.pressures(k),
      })),
    };
  }

  /** The gas pressure of each cylinder [Pa] at a time [s], on lines between the frames. */
  pressuresAt(time) {
    const { pressure_time: at, pressure } = this.given;
    if (!at.length) return () => 0;
    const k = cellOf(at, time);
    const s = (time - at[k]) / (at[k + 1] - at[k]);
    return (cylinder) => {
      const n = cylinder * at.length + k;
      return pressure[n] + s * (pressure[n + 1] - pressure[n]);
    };
  }
}

function cellOf(at, time) {
  return Math.min(Math.max(countUpTo(at, time) - 1, 0), at.length - 2);
}
