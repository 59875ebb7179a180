// a cycle that is computed is kept under the name of its case, for mutants that only show it
([script, text, { name, values, k, curves, poses, fresh }]) => {
  const page = eval(script);
  const given = page.given.valuesOf(JSON.parse(text));
  const turner = new page.turned.Turner(given);
  const own = new page.engine.Engine(given.rules);
  window.cycles ??= {};
  const asked = fresh ? turner.scene(values) : window.cycles[name].scene;
  const of = (scene) => page.cycle.cycleOf(own, scene, given.endings, { fine: true });
  const shown = fresh ? of(asked) : window.cycles[name];
  if (fresh) window.cycles[name] = shown;
  const root = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  root.style.width = "700px"; // room for names beside the drawing
  document.body.replaceChildren(root);
  const stage = new page.stage.Stage(root, given.compression, () => {});
  const attributes = (each) => each && Object.fromEntries(
    Array.from(each.attributes, (found) => [found.name, found.value]));
  const one = (what) => attributes(root.querySelector(what));
  const all = (what) => Array.from(root.querySelectorAll(what), (each) =>
    ({ ...attributes(each), text: each.textContent }));
  const posed = (body, n) => {
    const scenes = given.scene.crank.inertia;
    const ratio = scenes > 0 ? asked.crank.inertia / scenes : 1;
    shown.made.clear();
    stage.show(shown, { k, body, ratio, heavy: true });
    stage.pose(shown.angles[n]);
    return {
      pin: one(".chosen [data-grip=pin]"), rod: one(".chosen .rod"),
      piston: one(".chosen .piston"), web: one(".chosen .web"), mark: one(".mark"),
      ring: one(".ring g"), lead: one("path.lead"), says: stage.leadInWords(shown.angles[n]),
      arrows: all(".arrows path"), names: all(".arrows text"), bar: all(".scale *"),
      rim: one(".rim"), disc: one(".disc"),
    };
  };
  const bodies = ["piston", "rod", "crank"];
  const dead = page.geometry.deadCentres(shown.train.gears[k].shape);
  const middle = 0.5 * (shown.angles[77] + shown.angles[78]);
  const [, csv] = page.taken.dataFile(given, shown);
  // the stage's own observer, which tells it its size, was made before this one and is called first
  const fitted = new Promise((done) => new ResizeObserver(done).observe(root));
  return Promise.all([csv.text(), fitted]).then(([data]) => JSON.stringify({
    data,
    mean: shown.mean, gain: shown.gain, fluctuation: shown.fluctuation, leads: shown.leads,
    settled: shown.settled, prescribed: shown.prescribed, angles: shown.angles,
    lead: shown.leadAt(middle), ahead: shown.timeTo(middle),
    angle: shown.angleAt(shown.timeTo(middle) + 2 * shown.duration),
    curves: Object.fromEntries([...curves, "crank ahead of the mean"].map((curve) => {
      shown.made.clear(); // what it is drawn from is not there yet
      const drawn = page.quantities.drawn(curve, shown, k);
      return [curve, { ...drawn, now: drawn.of(shown.angles[100]) }];
    })),
    forces: bodies.map((body) => {
      const { forcesOn, forceAt } = page.forces;
      const forces = forcesOn(body, shown.train, k);
      return shown.samples.map((v) =>
        forces.map((each) => ({ name: each.name, at: each.at(v), force: forceAt(each, v) })));
    }),
    poses: bodies.map((body) => poses.map((n) => posed(body, n))),
    numbers: page.words.numbersOf(shown), badge: page.words.badgeOf(shown, given.endings),
    marks: page.words.deadCentreMarks(shown, k, dead),
    rim: page.drawing.inertiaOfRim(posed("none", 0).rim.r / 1000, asked.crank.radius),
  }));
}
