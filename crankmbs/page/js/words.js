/** What the page says in words about the motion that it shows. */
import { general, readable } from "./format.js";

const RPM = Math.PI / 30;

/** The numbers of the headline, [name, value] each. error : of the speed, relative, or null */
export function numbersOf(cycle, error) {
  const { measures, train } = cycle;
  const found = [
    ["mean speed", `${readable(cycle.mean / RPM, 1)} rpm`],
    ["fluctuation", `${readable(100 * cycle.fluctuation, 3)} %`],
  ];
  if (measures) {
    const outside = measures.external_torque;
    const drives = cycle.prescribed || outside * cycle.mean > 0;
    const name = drives ? "drive torque" : "load torque";
    found.push([name, `${readable(outside, 1)} N m`]);
    if (measures.indicated_power !== null) {
      found.push(["indicated power", `${readable(measures.indicated_power / 1e3, 2)} kW`]);
    }
    for (const end of ["head end", "crank end"]) {
      const power = measures[`indicated_power_${end.replace(" ", "_")}`];
      if (power !== undefined) found.push([`of the ${end}`, `${readable(power / 1e3, 2)} kW`]);
    }
  }
  if (measures && measures.friction_power !== null) {
    found.push(["friction power", `${readable(measures.friction_power / 1e3, 2)} kW`]);
    if (measures.mechanical_efficiency !== null) {
      const left = readable(100 * measures.mechanical_efficiency, 1);
      found.push(["mechanical efficiency", `${left} %`]);
    }
  }
  if (cycle.share !== 1) found.push(["load, rebalanced", `${readable(100 * cycle.share, 1)} %`]);
  const cells = train.cylinders.length > 1 ? [["cylinders", `${train.cylinders.length}`]] : [];
  const trust = error === null ? "…" : `${general(Math.max(error, 1e-15), 1)}`;
  return [...found, ...cells, ["error of the quick pass", trust]];
}

/** How far the cycle is one that repeats itself: { text, good }. sentences : of endings */
export function badgeOf(cycle, endings) {
  const gain = readable(Math.abs(cycle.gain), Math.abs(cycle.gain) < 10 ? 2 : 0);
  const drifts = `${cycle.gain > 0 ? "gains" : "loses"} ${gain} rpm a cycle`;
  if (cycle.prescribed) {
    const steady = Math.abs(cycle.drift) < 1e-9 * Math.abs(cycle.mean);
    return steady ? said("prescribed speed", true) : said(`prescribed speed: ${drifts}`, false);
  }
  if (cycle.scene.freed) {
    const held = "settled under the constant torque that balances the cycle";
    return cycle.motion.balanced
      ? said(`${held}: every speed would repeat itself, the mean prescribed is kept`, true)
      : said(`${held} at the mean speed prescribed`, true);
  }
  if (cycle.settled && cycle.motion.balanced) {
    return said("settled at any speed: the mean speed of the start is kept", true);
  }
  if (cycle.settled) return said("settled cycle: it repeats itself", true);
  if (cycle.train.fuel?.misfire.some(({ every }) => every)) {
    const once = drifts.replace(/ a cycle$/, "");
    return said(`one of several cycles, of which the last ${once}; ${endings.uneven}`, false);
  }
  const why = cycle.why === null ? "" : `; ${endings[cycle.why]}`;
  const which = cycle.scene.run.settled ? "first" : "last";
  return said(`not settled: the ${which} cycle ${drifts}${why}`, false);
}

function said(text, good) {
  return { text, good };
}

/** The true dead centres of a cylinder within a cycle, { degrees, name }. */
export function deadCentreMarks(cycle, k, { top, bottom }) {
  const { phase } = cycle.train.cylinders[k];
  const [low, high] = [Math.min(cycle.from, cycle.to), Math.max(cycle.from, cycle.to)];
  const found = [];
  for (const [centre, name] of [[top, "top"], [bottom, "bottom"]]) {
    const turn = 2 * Math.PI;
    const first = Math.ceil((low - centre + phase) / turn - 1e-9);
    for (let n = first; n * turn + centre - phase <= high + 1e-9; n++) {
      found.push({ degrees: ((n * turn + centre - phase) * 180) / Math.PI, name });
    }
  }
  return found;
}
