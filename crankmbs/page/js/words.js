/** What the page says in words about the motion that it shows. */
import { recurring } from "./arrays.js";
import { DEGREE, RPM, general, readable } from "./format.js";

/** The numbers of the headline, [name, value] each, those that say most first; what the quick pass
 * does not have stands as ... in its place. */
export function numbersOf(cycle) {
  const { measures, train } = cycle;
  const { external_torque: outside } = measures ?? cycle.rows[0];
  const drives = cycle.prescribed || outside * cycle.mean > 0;
  const shown = (of, si, decimals, unit) =>
    (measures ? `${readable(of(measures) / si, decimals)} ${unit}` : "…");
  const peak = (joint) => shown((found) => peakIn(found, joint), 1e3, 2, "kN");
  const power = (name) => shown((found) => found[name], 1e3, 2, "kW");
  const swing = ["fluctuation", `${readable(100 * cycle.fluctuation, 3)} %`];
  const found = [
    ["mean speed", `${readable(cycle.mean / RPM, 1)} rpm`],
    ["side force, peak", peak("side force")],
    ["main bearing, peak", peak("main bearing")],
    ["crank pin, peak", peak("crank pin")],
    [drives ? "drive torque" : "load torque", shown(() => outside, 1, 1, "N m")],
  ];
  if (train.pressure.length) found.push(["indicated power", power("indicated_power")]);
  for (const end of train.crank_end.length ? ["head end", "crank end"] : []) {
    found.push([`of the ${end}`, power(`indicated_power_${end.replace(" ", "_")}`)]);
  }
  if (train.friction !== null) {
    found.push(["friction power", power("friction_power")]);
    const left = shown((each) => 100 * each.mechanical_efficiency, 1, 1, "%");
    if (measures?.mechanical_efficiency !== null) found.push(["mechanical efficiency", left]);
  }
  if (train.applies) found.push(["power of applied forces", power("force_power")]);
  found.splice(cycle.prescribed ? 4 : 1, 0, swing); // what swings by itself comes first
  const count = train.cylinders.length;
  return count > 1 ? [...found, ["cylinders", `${count}`]] : found;
}

/** The greatest force [N] in a joint of any cylinder. */
function peakIn({ joints }, wanted) {
  return Math.max(...joints.map(({ joint, peak }) => (joint === wanted ? peak : 0)));
}

/** How exact what is shown is. error : of the quick pass, relative, or null */
export function trustOf({ prescribed }, error) {
  if (prescribed) {
    return "The speed is prescribed: motion and forces follow by formulas, without integration.";
  }
  const trust = error === null ? "…" : general(Math.max(error, 1e-15), 1);
  return `Numerical error of the speed: ${trust} of its mean while a knob moves, less at rest.`;
}

/** How far the cycle is one that repeats itself: { text, good }. sentences : of endings */
export function badgeOf(cycle, endings) {
  const gain = readable(Math.abs(cycle.gain), Math.abs(cycle.gain) < 10 ? 2 : 0);
  const drifts = `${cycle.gain > 0 ? "gains" : "loses"} ${gain} rpm`;
  if (cycle.prescribed) {
    const steady = Math.abs(cycle.drift) < 1e-9 * Math.abs(cycle.mean);
    if (steady) return { text: "prescribed speed", good: true };
    return { text: `prescribed speed: ${drifts} a cycle`, good: false };
  }
  if (cycle.scene.freed) {
    const speed = cycle.motion.balanced
      ? ": every speed would repeat itself, the mean prescribed is kept"
      : " at the mean speed prescribed";
    const held = "settled under the constant torque that balances the cycle";
    return { text: `${held}${speed}`, good: true };
  }
  if (cycle.settled && cycle.motion.balanced) {
    return { text: "settled at any speed: the mean speed of the start is kept", good: true };
  }
  const count = Math.round(Math.abs(cycle.to - cycle.from) / cycle.scene.period);
  if (cycle.settled) {
    const repeats = count > 1 ? `these ${count} cycles repeat` : "every cycle is like this one";
    return { text: `settled motion: ${repeats}`, good: true };
  }
  if (cycle.train.fuel?.misfire.some(({ every }) => every)) {
    const text = `one of several cycles, of which the last ${drifts}; ${endings.uneven}`;
    return { text, good: false };
  }
  const why = cycle.why === null ? "" : `; ${endings[cycle.why]}`;
  const which = cycle.scene.run.settled ? "first" : "last";
  return { text: `not settled: the ${which} cycle ${drifts}${why}`, good: false };
}

/** The true dead centres of a cylinder within a cycle, { degrees, name }. */
export function deadCentreMarks(cycle, k, { top, bottom }) {
  const { phase } = cycle.train.cylinders[k];
  return [[top, "top"], [bottom, "bottom"]].flatMap(([centre, name]) =>
    recurring([centre - phase], 2 * Math.PI, cycle.from, cycle.to)
      .map((theta) => ({ degrees: theta / DEGREE, name })));
}
