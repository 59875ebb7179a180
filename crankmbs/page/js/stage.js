/** The mechanism, to scale: crank, rods, pistons, cylinders and flywheel, the forces on one body,
 * and a ring that turns at the mean speed. */
import { isSame } from "./arrays.js";
import { proportions } from "./drawing.js";
import { BODIES, forceAt, forcesOn } from "./forces.js";
import { general, readable, roundBelow } from "./format.js";
import { turnedBy } from "./geometry.js";
import { LETTER, boxBeside, looksOf, namesBeside, whichOf } from "./labels.js";
import { arrowOf, rodOf, webOf } from "./outlines.js";
import { sizeOf } from "./shapes.js";
import { Pen, add, set, turn, watched } from "./svg.js";

const REACH = 1.2; // of the crank radius: the longest arrow
const LEAD = (14 * Math.PI) / 180; // the ring's magnified lead, at most
const TICKS = 24;
const UNITS = 1000; // of the drawing per metre
const SMALL = 0.85; // of the page's type: letters in the drawing
const FOOT = 1.8; // of the letters' height, below the drawing: the scale of the forces
const ROW = 1.4; // the same: which cylinder is shown
const SHORTEST = 0.01; // of the largest force: what has an arrow
const FEW = 3; // of so many samples one: they tell how large forces and pressure become

export class Stage {
  /** root : its svg; compression : the ratio that the scene has, or null; resized : called when its
   * size has changed */
  constructor(root, compression, resized) {
    Object.assign(this, { root, compression, size: { width: 300, height: 300, type: 16 } });
    watched(root, (size) => {
      this.size = size;
      resized();
    });
  }

  /** Show another cycle: of cylinder k from 0, the forces on a body or "none"; ratio : of the
   * flywheel's inertia to the scene's own; heavy : whether its rim can be dragged. */
  show(cycle, { k, body, ratio, heavy }) {
    const { train } = cycle;
    Object.assign(this, { cycle, train, k });
    this.sizes = proportions(train, ratio, this.compression);
    this.measure(cycle, body, k);
    [this.lean] = onScreen(turnedBy(train.cylinders[k].bank, 1, 0));
    const pressures = cycle.samplesOf(k, FEW).map((v) => v.cylinders[k].gas_pressure);
    this.most = Math.max(...pressures, 1);
    const lead = sizeOf([cycle.leads]);
    this.magnified = lead > 1e-9 ? Math.max(roundBelow(LEAD / lead), 1) : 0;
    const made = [k, train.cylinders, heavy, this.magnified > 0];
    if (!isSame(made, this.made)) this.make(heavy);
    this.made = made;
    this.fit();
    this.fitScale();
  }

  /** The largest force of the cycle on a body [N], and the letters of the longest name. */
  measure(cycle, body, k) {
    this.forces = BODIES.includes(body) ? forcesOn(body, this.train, k) : [];
    this.letters = Math.max(0, ...this.forces.map(({ name }) => name.length));
    let square = 0;
    for (const v of this.forces.length ? cycle.samplesOf(body === "crank" ? null : k, FEW) : []) {
      for (const { x, y } of this.forces) square = Math.max(square, x(v) ** 2 + y(v) ** 2);
    }
    this.largest = Math.sqrt(square);
  }

  /** How long the arrow of a force [N] is drawn: by its root, so that small ones show where to. */
  lengthOf(newtons) {
    return REACH * this.sizes.r * UNITS * Math.sqrt(newtons / this.largest);
  }

  /** The elements, in the order in which they cover each other. */
  make(heavy) {
    const { root, train } = this;
    root.replaceChildren();
    const flywheel = add(root, "g", { class: "flywheel" });
    this.discs = [add(flywheel, "circle", { class: "disc" })];
    this.mark = add(flywheel, "path", { class: "mark" });
    this.discs.push(add(flywheel, "circle", { class: "rim" }));
    const hold = { class: "hold grip", "data-grip": "rim" };
    if (heavy) this.discs.push(add(flywheel, "circle", hold));
    const order = train.cylinders.map((_, k) => k).filter((k) => k !== this.k);
    this.parts = [];
    for (const k of [...order, this.k]) this.parts[k] = this.cylinder(k);
    this.axle = add(root, "circle", { class: "axle" });
    this.which = add(root, "text", { class: "which" }, whichOf(train, this.k));
    const ring = add(root, "g", { class: "ring" });
    if (this.magnified) {
      this.track = add(ring, "circle", { class: "track" });
      this.turning = add(ring, "g");
      this.ticks = add(this.turning, "path", { class: "tick" });
      this.pointer = add(this.turning, "path", { class: "pointer" });
      this.wedge = add(ring, "path");
      this.fitRing();
    }
    this.arrows = add(root, "g", { class: "arrows" });
    this.bar = add(root, "g", { class: "scale" });
  }

  /** The sizes of all that stands still. */
  fit() {
    const { root, sizes, parts, axle, which } = this;
    const scaled = Object.entries(sizes.bounds).map(([side, value]) => [side, UNITS * value]);
    const drawn = Object.fromEntries(scaled);
    const words = { letters: this.letters, type: SMALL * this.size.type, lean: this.lean };
    const rows = (this.letters ? FOOT : 0) + (parts.length > 1 ? ROW : 0);
    const foot = rows * words.type;
    const size = { ...this.size, height: Math.max(this.size.height - foot, 0) };
    const { left, top, width, height, scale } = boxBeside(drawn, size, words);
    const high = height + foot / scale;
    set(root, { viewBox: `${left} ${top} ${width} ${high}` });
    const px = (1 / scale).toPrecision(2); // lines are about as wide on every screen
    if (px !== this.px) root.style.setProperty("--px", px); // which is a new style for every part
    this.px = px;
    this.type = (SMALL * this.size.type) / scale;
    const middle = left + 0.5 * width; // what is wider than the drawing is room beside it
    set(which, { x: middle, y: top + high - 0.4 * this.type, "font-size": this.type });
    const half = (0.5 * this.size.width) / scale;
    const above = top + 0.5 * (high - this.size.height / scale);
    this.sides = { ...drawn, right: drawn.left + drawn.width };
    this.edge = { left: middle - half, right: middle + half, top: above };
    parts.forEach((part, k) => this.fitCylinder(part, sizes.each[k]));
    set(axle, { r: 0.13 * sizes.r * UNITS });
    for (const disc of this.discs) set(disc, { r: sizes.rim * UNITS });
  }

  /** Ticks of the ring at mean speed, and its pointer. */
  fitRing() {
    const radius = this.sizes.ring * UNITS;
    set(this.track, { r: radius });
    const tick = (n, inner) => {
      const angle = (2 * Math.PI * n) / TICKS;
      const [x, y] = [-radius * Math.sin(angle), -radius * Math.cos(angle)];
      return `M${inner * x} ${inner * y}L${x} ${y}`;
    };
    const ticks = Array.from({ length: TICKS - 1 }, (_, n) => tick(n + 1, 0.97)).join("");
    set(this.ticks, { d: ticks });
    set(this.pointer, { d: tick(0, 0.9) });
  }

  /** A bar as long as a round force, below the drawing. */
  fitScale() {
    const { largest, bar, type } = this;
    const pen = new Pen(bar);
    if (!largest) return pen.end();
    const newtons = roundBelow(largest / 2.2);
    const long = this.lengthOf(newtons);
    const { left, top, height } = this.sides;
    const size = newtons >= 1000 ? `${general(newtons / 1000)} kN` : `${general(newtons)} N`;
    const text = `${size} (length ∝ √force)`;
    const wide = long + LETTER * type * (text.length + 1);
    const x = Math.max(Math.min(left, this.edge.right - wide), this.edge.left);
    const y = top + height + (FOOT - 0.5) * type;
    pen.add("path", { d: `M${x} ${y - 0.4 * type}v${0.4 * type}h${long}v${-0.4 * type}` });
    pen.add("text", { x: x + long + 0.5 * type, y, "font-size": type }, text);
    return pen.end();
  }

  /** Still parts of a cylinder, and those that move. */
  cylinder(k) {
    const { bank } = this.train.cylinders[k];
    const looks = looksOf(this.train, k, this.k);
    const group = add(this.root, "g", { class: looks });
    const fixed = add(group, "g");
    const pale = looks === "cylinder pale"; // no cylinder is drawn around its piston
    const gas = pale ? null : add(fixed, "rect", { class: "gas" });
    const wall = pale ? null : add(fixed, "path", { class: "wall" });
    const piston = add(fixed, "g", { class: "piston grip", "data-grip": "piston", "data-k": k });
    const body = add(piston, "rect");
    const grooves = add(piston, "path", { class: "groove" });
    const crank = add(group, "path", { class: "web grip", "data-grip": "crank", "data-k": k });
    const rod = add(group, "g", { class: "rod" });
    const bar = add(rod, "path");
    const small = add(rod, "circle", { class: "eye" });
    const pin = add(group, "circle", { class: "eye grip", "data-grip": "pin", "data-k": k });
    return { bank, fixed, gas, wall, piston, body, grooves, crank, rod, bar, small, pin };
  }

  fitCylinder(part, sizes) {
    const { bank, fixed, gas, wall, body, grooves, crank, bar, small, pin } = part;
    const scale = (value) => value * UNITS;
    const middle = -scale(sizes.offset);
    const half = scale(0.5 * sizes.width);
    const [head, low] = [-scale(sizes.head), -scale(sizes.low)];
    Object.assign(part, { head, middle });
    set(fixed, { transform: `${turn(bank)} translate(${middle} 0)` });
    if (wall) {
      set(gas, { x: -half, width: 2 * half, y: head });
      const thick = scale(0.06 * sizes.width);
      const edge = half + thick / 2;
      const d = `M${-edge} ${low}V${head - thick / 2}H${edge}V${low}`;
      set(wall, { d, "stroke-width": thick });
    }
    const [x, width, crown] = [-0.985 * half, 1.97 * half, scale(sizes.crown)];
    const high = crown + scale(sizes.skirt);
    set(body, { x, width, y: -crown, height: high, rx: 0.09 * half });
    const groove = (n) => `M${x} ${-crown * (1 - 0.16 * n)}h${width}`;
    set(grooves, { d: [1, 2, 3].map(groove).join("") });
    set(crank, { d: webOf(scale(sizes.r)) });
    set(bar, { d: rodOf(scale(sizes.length), 0.17 * scale(sizes.r), 0.1 * scale(sizes.r)) });
    set(pin, { r: 0.2 * scale(sizes.r) });
    set(small, { r: 0.13 * scale(sizes.r) });
  }

  /** Move everything to a crank angle [rad]. */
  pose(theta) {
    const v = this.cycle.at(theta);
    this.parts.forEach((_, k) => this.poseCylinder(k, theta, v.cylinders[k]));
    const rim = this.sizes.rim * UNITS;
    const notch = 0.12 * this.sizes.r * UNITS;
    const d = `M0 ${-rim}l${-notch} ${2 * notch}h${2 * notch}Z`;
    set(this.mark, { d, transform: turn(theta) });
    this.poseRing(theta);
    this.poseArrows(v);
  }

  poseCylinder(k, theta, at) {
    const { train, parts } = this;
    const sizes = this.sizes.each[k];
    const { phase, bank } = train.cylinders[k];
    const { gas, piston, crank, rod, pin, head, middle } = parts[k];
    const r = sizes.r * UNITS;
    const x = at.piston_position * UNITS;
    set(piston, { transform: `translate(0 ${-x})` });
    if (gas) {
      const crown = -x - sizes.crown * UNITS;
      const share = Math.min(Math.max(at.gas_pressure / this.most, 0), 1);
      const opacity = 0.08 + 0.8 * Math.sqrt(share);
      set(gas, { height: Math.max(crown - head, 0), "fill-opacity": opacity });
    }
    const angle = theta + phase + bank;
    const [cx, cy] = onScreen(turnedBy(angle, r, 0));
    const [px, py] = onScreen(turnedBy(bank, x, -middle));
    set(crank, { transform: turn(angle) });
    const lean = Math.atan2(cx - px, cy - py);
    set(rod, { transform: `translate(${px} ${py}) ${turn(lean)}` });
    set(pin, { cx, cy });
  }

  /** The ring stands where an evenly turning crank would, its lag or lead magnified. */
  poseRing(theta) {
    if (!this.magnified) return;
    const lead = this.magnified * this.cycle.leadAt(theta);
    set(this.turning, { transform: turn(theta - lead) });
    const radius = 0.985 * this.sizes.ring * UNITS;
    const [ax, ay] = onScreen(turnedBy(theta, radius, 0));
    const [bx, by] = onScreen(turnedBy(theta - lead, radius, 0));
    set(this.wedge, {
      d: `M${bx} ${by}A${radius} ${radius} 0 0 ${lead > 0 ? 0 : 1} ${ax} ${ay}`,
      class: `lead ${lead * this.cycle.sense > 0 ? "ahead" : "behind"}`,
    });
  }

  /** What the ring says in words. */
  leadInWords(theta) {
    if (!this.magnified) return "the crank turns evenly";
    const lead = (this.cycle.leadAt(theta) * this.cycle.sense * 180) / Math.PI;
    const decimals = Math.min(Math.max(2 + Math.floor(Math.log10(this.magnified)), 1), 6);
    const where = lead < 0 ? "behind" : "ahead of";
    const drawn = this.magnified > 1 ? ` (drawn ${general(this.magnified)}×)` : "";
    return `crank ${readable(Math.abs(lead), decimals)}° ${where} steady rotation${drawn}`;
  }

  poseArrows(v) {
    const { arrows, forces, largest, train, k, sizes } = this;
    const pen = new Pen(arrows);
    const names = [];
    const own = sizes.each[k];
    for (const each of largest ? forces : []) {
      const { name, kind, at, onCrown, onSkirt, onSide } = each;
      const [fx, fy] = forceAt(each, v);
      const size = Math.hypot(fx, fy);
      if (size < SHORTEST * largest) continue;
      const [dx, dy] = onScreen([fx, fy].map((part) => (part / size) * this.lengthOf(size)));
      let [x, y] = onScreen(at(v).map((part) => part * UNITS));
      let pushes = false;
      if (onCrown || onSkirt) {
        const far = onCrown ? own.crown : -own.skirt;
        const [ux, uy] = onScreen(turnedBy(train.cylinders[k].bank, far * UNITS, 0));
        pushes = dx * ux + dy * uy < 0; // then its tip is on the piston
        [x, y] = pushes ? [x + ux - dx, y + uy - dy] : [x + ux, y + uy];
      }
      if (onSide) {
        const half = 0.5 * onSide(v) * own.width * UNITS;
        const [ux, uy] = onScreen(turnedBy(train.cylinders[k].bank, 0, half));
        [x, y] = [x + ux, y + uy];
      }
      pen.add("path", { d: arrowOf(x, y, dx, dy, 0.055 * sizes.r * UNITS), class: kind });
      names.push({ name, kind, x: x + (pushes ? 0 : dx), y: y + (pushes ? 0 : dy) });
    }
    namesBeside(pen, names, this);
    pen.end();
  }
}

function onScreen([x, y]) {
  return [-y, -x];
}
