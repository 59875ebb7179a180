// a cycle is kept under the name of its case, for mutants that only show it; fresh: it is computed
// by the script, and not kept
(script, text, { name, values, k, curves, fresh }) => {
  globalThis.Blob = class {
    constructor(parts) {
      this.content = parts.join("");
    }
  };
  const cycles = (globalThis.cycles ??= {});
  const page = eval(script);
  const given = page.given.valuesOf(JSON.parse(text));
  const solved = () => page.cycle.cycleOf(
    new page.engine.Engine(given.rules), new page.turned.Turner(given).scene(values),
    given.endings, { fine: true });
  const shown = fresh ? solved() : (cycles[name] ??= solved());
  const dead = page.geometry.deadCentres(shown.train.gears[k].shape);
  const middle = 0.5 * (shown.angles[77] + shown.angles[78]);
  const [, csv] = page.taken.dataFile(given, shown);
  return {
    data: csv.content,
    mean: shown.mean, gain: shown.gain, fluctuation: shown.fluctuation, leads: shown.leads,
    settled: shown.settled, prescribed: shown.prescribed, angles: shown.angles,
    lead: shown.leadAt(middle), ahead: shown.timeTo(middle),
    angle: shown.angleAt(shown.timeTo(middle) + 2 * shown.duration),
    curves: Object.fromEntries([...curves, "crank ahead of the mean"].map((curve) => {
      shown.made.clear(); // what it is drawn from is not there yet
      const drawn = page.quantities.drawn(curve, shown, k);
      return [curve, { ...drawn, now: drawn.of(shown.angles[100]) }];
    })),
    forces: ["piston", "rod", "crank"].map((body) => {
      const { forcesOn, forceAt } = page.forces;
      const forces = forcesOn(body, shown.train, k);
      return shown.samples.map((v) =>
        forces.map((each) => ({ name: each.name, at: each.at(v), force: forceAt(each, v) })));
    }),
    numbers: page.words.numbersOf(shown), badge: page.words.badgeOf(shown, given.endings),
    marks: page.words.deadCentreMarks(shown, k, dead),
  };
}
