// a cycle is kept under the name of its case, for mutants that only draw it
([script, text, { name, values, k, poses }]) => {
  window.cycles ??= {};
  const page = eval(script);
  const given = page.given.valuesOf(JSON.parse(text));
  const shown = window.cycles[name] ??= page.cycle.cycleOf(
    new page.engine.Engine(given.rules), new page.turned.Turner(given).scene(values),
    given.endings, { fine: true });
  const { crank } = shown.scene;
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
    const ratio = scenes > 0 ? crank.inertia / scenes : 1;
    shown.made.clear(); // what it is drawn from is not there yet
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
  // the stage's own observer, which tells it its size, was made before this one and is called first
  return new Promise((fitted) => new ResizeObserver(fitted).observe(root)).then(() =>
    JSON.stringify({
      poses: ["piston", "rod", "crank"].map((body) => poses.map((n) => posed(body, n))),
      rim: page.drawing.inertiaOfRim(posed("none", 0).rim.r / 1000, crank.radius),
    }));
}
