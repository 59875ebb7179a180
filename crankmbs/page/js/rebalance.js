/** Loads scaled so that a motion settles to a wanted mean speed, as a brake is turned up or down
 * until the speed is what it was before a knob moved.
 *
 * Those loads are scaled, all by one share, that take work at that speed; where none does, those
 * that give some. A period of that duration is sought which gains nothing: the duration falls about
 * as the inverse root of the energy at its begin, the gain rises with the share by the work of the
 * loads.
 */
import { branchAt, firstPhases, torqueOf } from "./loads.js";
import { Section } from "./settled.js";

const ROUNDS = 40;

/** { ending, share, scene } : the scene, its loads scaled by the share, settles to the mean speed
 * [rad/s]; ending "complete", "unbalanced" where no share will do, or what ends the period.
 *
 * closeness : relative, of mean speed and share
 */
export function rebalanced(scene, speed, { train, grid }, closeness) {
  const sense = Math.sign(speed);
  const start = { ...scene.start, speed };
  const given = scene.loads.map((load) => sense * torqueAt(load, speed));
  const side = given.some((torque) => torque < 0) ? -1 : 1;
  const chosen = given.map((torque) => side * torque > 0);
  const scaled = (share) => scene.loads.map((load, k) => (chosen[k] ? times(load, share) : load));
  const work = given.reduce((sum, torque, k) => sum + (chosen[k] ? torque : 0), 0);
  let [share, energy] = [1, null];
  for (let n = 0; work !== 0 && n < ROUNDS; n++) {
    const loads = scaled(share);
    const section = new Section({ ...train, loads }, grid, start, sense);
    energy ??= section.energyAt(speed);
    const { ending, gained, time } = section.once(energy, start);
    if (ending !== "complete") return { ending, share, scene };
    const late = (time * Math.abs(speed)) / section.period - 1;
    const more = -gained / (work * section.period);
    if (Math.abs(late) < closeness && Math.abs(more) < closeness * share) {
      return { ending, share, scene: { ...scene, loads, start } };
    }
    energy *= (1 + late) ** 2;
    share += more;
    if (!(share > 0)) break;
  }
  return { ending: "unbalanced", share, scene };
}

/** Torque of a load at a speed [N m]. */
function torqueAt(load, omega) {
  const branch = branchAt([load], firstPhases([load], omega), 0, omega, Math.sign(omega));
  return branch === null ? 0 : torqueOf(branch, 0, omega);
}

/** A load of which there is as much. */
function times(load, share) {
  const more = (part) => part && { ...part, pieces: part.pieces.map((each) => share * each) };
  return { ...load, over_time: more(load.over_time), over_speed: more(load.over_speed) };
}
