/** The mechanism, to scale: crank, rods, pistons, cylinders and flywheel, the forces on one body,
 * and a ring that turns at the mean speed. */
import { proportions, turnedBy } from "./drawing.js";
import { BODIES, forcesOn } from "./forces.js";
import { general, readable, roundBelow } from "./format.js";
import { Pen, add, set, watched } from "./svg.js";

const REACH = 1.2; // of the crank radius: the longest arrow
const LEAD = (14 * Math.PI) / 180; // the ring's magnified lead, at most
const TICKS = 24;
const UNITS = 1000; // of the drawing per metre
const SMALL = 0.85; // of the page's type: letters in the drawing
const LETTER = 0.62; // of the type: how wide a bold letter is

export class Stage {
  /** root : its svg; compression : the ratio that the scene has, or null; resized : called when its
   * size has changed */
  constructor(root, compression, resized) {
    this.root = root;
    this.compression = compression;
    this.size = { width: 300, height: 300, type: 16 };
    watched(root, (size) => {
      this.size = size;
      resized();
    });
  }

  /** Show another cycle: of cylinder k from 0, the forces on a body or "none"; ratio : of the
   * flywheel's inertia to the scene's own; heavy : whether its rim can be dragged. */
  show(cycle, { k, body, ratio, heavy }) {
    const { train } = cycle;
    Object.assign(this, { cycle, train, k, body });
    this.sizes = proportions(train, ratio, this.compression);
    this.force = this.scaleOf(cycle, body, k);
    this.most = Math.max(...cycle.samples.map((v) => v.cylinders[k].gas_pressure), 1);
    const lead = Math.max(...cycle.leads.map(Math.abs));
    this.magnified = lead > 1e-9 ? Math.max(roundBelow(LEAD / lead), 1) : 0;
    const { rim, ...others } = this.sizes;
    const all = [others, this.size, k, train.cylinders, heavy, this.magnified, train.shape];
    const as = JSON.stringify(all);
    if (as !== this.as) this.build(heavy);
    this.as = as;
    for (const disc of this.discs) set(disc, { r: rim * UNITS });
    this.buildScale();
  }

  /** Metres of arrow per newton, from the largest force of the cycle. */
  scaleOf(cycle, body, k) {
    if (!BODIES.includes(body)) return 0;
    let most = 0;
    for (const v of cycle.samples) {
      for (const { force } of forcesOn(body, this.train, v, k)) {
        most = Math.max(most, Math.hypot(...force));
      }
    }
    this.largest = most;
    return most > 0 ? (REACH * this.sizes.r) / most : 0;
  }

  build(heavy) {
    const { root, sizes, train } = this;
    const { left, top, width, height } = scaledBox(sizes.bounds);
    set(root, { viewBox: `${left} ${top} ${width} ${height}` });
    root.replaceChildren();
    const scale = Math.min(this.size.width / width, this.size.height / height) || 1;
    this.type = (SMALL * this.size.type) / scale;
    const middle = left + 0.5 * width; // what is wider than the drawing is room beside it
    const half = (0.5 * this.size.width) / scale;
    this.edge = { left: middle - half, right: middle + half };
    const flywheel = add(root, "g", { class: "flywheel" });
    this.discs = [add(flywheel, "circle", { class: "disc" })];
    this.mark = add(flywheel, "path", { class: "mark" });
    this.discs.push(add(flywheel, "circle", { class: "rim" }));
    const hold = { class: "hold grip", "data-grip": "rim" };
    if (heavy) this.discs.push(add(flywheel, "circle", hold));
    const order = train.cylinders.map((_, k) => k).filter((k) => k !== this.k);
    this.parts = [];
    for (const k of [...order, this.k]) this.parts[k] = this.cylinder(k);
    this.axle = add(root, "circle", { r: 0.13 * sizes.r * UNITS, class: "axle" });
    this.ring = add(root, "g", { class: "ring" });
    this.buildRing();
    this.arrows = add(root, "g", { class: "arrows" });
    this.bar = add(root, "g", { class: "scale" });
  }

  /** Ticks of the ring at mean speed, and its pointer. */
  buildRing() {
    if (!this.magnified) return;
    const radius = this.sizes.ring * UNITS;
    add(this.ring, "circle", { r: radius, class: "track" });
    this.turning = add(this.ring, "g");
    for (let n = 0; n < TICKS; n++) {
      const angle = (2 * Math.PI * n) / TICKS;
      const [x, y] = [-Math.sin(angle), -Math.cos(angle)];
      const inner = (n === 0 ? 0.9 : 0.97) * radius;
      const ends = { x1: inner * x, y1: inner * y, x2: radius * x, y2: radius * y };
      add(this.turning, "line", { ...ends, class: n === 0 ? "pointer" : "tick" });
    }
    this.wedge = add(this.ring, "path", { class: "lead" });
  }

  /** A bar as long as a round force. */
  buildScale() {
    const { force, bar, type } = this;
    bar.replaceChildren();
    if (!force) return;
    const newtons = roundBelow(this.largest / 2.2);
    const long = newtons * force * UNITS;
    const { left, top, height } = scaledBox(this.sizes.bounds);
    const [x, y] = [left + 0.4 * type, top + height - 0.5 * type];
    add(bar, "path", { d: `M${x} ${y - 0.3 * type}v${0.3 * type}h${long}v${-0.3 * type}` });
    const size = newtons >= 1000 ? `${general(newtons / 1000)} kN` : `${general(newtons)} N`;
    const at = { x, y: y - 0.6 * type, "font-size": type };
    add(bar, "text", at, `${size}, on the ${this.body}`);
  }

  /** Still parts of a cylinder, and those that move. */
  cylinder(k) {
    const { sizes, train, root } = this;
    const { bank } = train.cylinders[k];
    const group = add(root, "g", { class: this.looks(k) });
    const fixed = add(group, "g", { transform: `rotate(${(-bank * 180) / Math.PI})` });
    const scale = (value) => value * UNITS;
    const middle = -scale(train.shape.offset);
    const half = scale(0.5 * sizes.width);
    const [head, low] = [-scale(sizes.head), -scale(sizes.low)];
    const gas = add(fixed, "rect", { x: middle - half, width: 2 * half, y: head, class: "gas" });
    const wall = scale(0.06 * sizes.width);
    const d = `M${middle - half - wall / 2} ${low}V${head - wall / 2}` +
      `H${middle + half + wall / 2}V${low}`;
    add(fixed, "path", { d, class: "wall", "stroke-width": wall });
    const piston = add(fixed, "g", { class: "piston grip", "data-grip": "piston", "data-k": k });
    const body = { x: middle - half * 0.985, width: 1.97 * half, y: -scale(sizes.crown) };
    add(piston, "rect", { ...body, height: scale(sizes.crown + sizes.skirt), rx: 0.09 * half });
    for (const n of [1, 2, 3]) {
      const y = -scale(sizes.crown) * (1 - 0.16 * n);
      add(piston, "line", { x1: body.x, x2: body.x + body.width, y1: y, y2: y, class: "groove" });
    }
    const crank = add(group, "path", { class: "web grip", "data-grip": "crank", "data-k": k });
    const rod = add(group, "path", { class: "rod" });
    const big = { r: 0.2 * scale(sizes.r), class: "eye grip", "data-grip": "pin", "data-k": k };
    const pin = add(group, "circle", big);
    const small = { r: 0.13 * scale(sizes.r), class: "eye" };
    return { gas, piston, crank, rod, pin, small: add(group, "circle", small), head, middle };
  }

  /** The chosen cylinder and others that stand beside it are drawn in full, the rest pale. */
  looks(k) {
    const { cylinders } = this.train;
    const apart = cylinders[k].bank !== cylinders[this.k].bank;
    const first = cylinders.findIndex(({ bank }) => bank === cylinders[k].bank) === k;
    if (k === this.k) return "cylinder chosen";
    return apart && first ? "cylinder" : "cylinder pale";
  }

  /** Move everything to a crank angle [rad]. */
  pose(theta) {
    const v = this.cycle.at(theta);
    this.parts.forEach((_, k) => this.poseCylinder(k, theta, v.cylinders[k]));
    const rim = this.sizes.rim * UNITS;
    const turn = (angle) => `rotate(${(-angle * 180) / Math.PI})`;
    const notch = 0.12 * this.sizes.r * UNITS;
    set(this.mark, {
      d: `M0 ${-rim}l${-notch} ${2 * notch}h${2 * notch}Z`,
      transform: turn(theta),
    });
    this.poseRing(theta, turn);
    this.poseArrows(v);
    return v;
  }

  poseCylinder(k, theta, at) {
    const { sizes, train, parts } = this;
    const { phase, bank } = train.cylinders[k];
    const { gas, piston, crank, rod, pin, small, head, middle } = parts[k];
    const r = sizes.r * UNITS;
    const x = at.piston_position * UNITS;
    set(piston, { transform: `translate(0 ${-x})` });
    const crown = -x - sizes.crown * UNITS;
    const share = Math.min(Math.max(at.gas_pressure / this.most, 0), 1);
    const opacity = 0.08 + 0.8 * Math.sqrt(share);
    set(gas, { height: Math.max(crown - head, 0), "fill-opacity": opacity });
    const angle = theta + phase + bank;
    const [cx, cy] = onScreen(turnedBy(angle, r, 0));
    const [px, py] = onScreen(turnedBy(bank, x, -middle));
    set(crank, { d: webOf(r), transform: `rotate(${(-angle * 180) / Math.PI})` });
    set(rod, { d: rodOf([cx, cy], [px, py], 0.17 * r, 0.1 * r) });
    set(pin, { cx, cy });
    set(small, { cx: px, cy: py });
  }

  /** The ring stands where an evenly turning crank would, its lag or lead magnified. */
  poseRing(theta, turn) {
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
    return `crank ${readable(Math.abs(lead), decimals)}° ${where} a ring at mean speed, ` +
      `shown ${general(this.magnified)} times`;
  }

  poseArrows(v) {
    const { arrows, force, train, k, body, sizes } = this;
    const pen = new Pen(arrows);
    const acting = force ? forcesOn(body, train, v, k) : [];
    for (const { name, kind, at, force: [fx, fy], onCrown, onSide } of acting) {
      const [dx, dy] = onScreen([fx * force * UNITS, fy * force * UNITS]);
      const long = Math.hypot(dx, dy);
      if (long < 0.02 * sizes.r * UNITS) continue;
      let [x, y] = onScreen([at[0] * UNITS, at[1] * UNITS]);
      let pushes = false;
      if (onCrown) {
        const [ux, uy] = onScreen(turnedBy(train.cylinders[k].bank, sizes.crown * UNITS, 0));
        pushes = dx * ux + dy * uy < 0; // then its tip is on the crown
        [x, y] = pushes ? [x + ux - dx, y + uy - dy] : [x + ux, y + uy];
      }
      if (onSide) {
        const half = 0.5 * onSide * sizes.width * UNITS;
        const [ux, uy] = onScreen(turnedBy(train.cylinders[k].bank, 0, half));
        [x, y] = [x + ux, y + uy];
      }
      pen.add("path", { d: arrowOf(x, y, dx, dy, 0.055 * sizes.r * UNITS), class: kind });
      const [ex, ey] = pushes ? [-0.02 * dx, -0.02 * dy] : [dx, dy]; // whence its name
      const place = this.placed(ex, ey, { x: x + ex, y: y + ey, name });
      pen.add("text", { "font-size": this.type, class: kind, ...place }, name);
    }
    pen.end();
  }

  /** Where an arrow's name stands: beyond its tip, but within the drawing. */
  placed(dx, dy, { x, y, name }) {
    const { type, edge } = this;
    const long = Math.hypot(dx, dy);
    const side = Math.abs(dx) < 0.35 * long ? 1 : Math.sign(dx);
    const wide = LETTER * type * name.length;
    const beyond = x + 0.35 * side * type;
    const [anchor, near] = side > 0
      ? ["start", Math.min(beyond, edge.right - wide)]
      : ["end", Math.max(beyond, edge.left + wide)];
    return { "text-anchor": anchor, x: near, y: y + (0.7 * dy * type) / long };
  }
}

function onScreen([x, y]) {
  return [-y, -x];
}

function scaledBox({ left, top, width, height }) {
  return { left: left * UNITS, top: top * UNITS, width: width * UNITS, height: height * UNITS };
}

function arrowOf(x, y, dx, dy, half) {
  const long = Math.hypot(dx, dy);
  const [ux, uy] = [dx / long, dy / long];
  const head = Math.min(5 * half, 0.6 * long);
  const neck = long - head;
  const at = (along, across) =>
    `${(x + along * ux - across * uy).toFixed(1)} ${(y + along * uy + across * ux).toFixed(1)}`;
  return `M${at(0, -half)}L${at(neck, -half)}L${at(neck, -2.2 * half)}L${at(long, 0)}` +
    `L${at(neck, 2.2 * half)}L${at(neck, half)}L${at(0, half)}Z`;
}

/** A crank web with its counterweight, the throw upwards. */
function webOf(r) {
  const [w, c] = [0.24 * r, 0.72 * r];
  return `M${-w} ${-r}A${w} ${w} 0 0 1 ${w} ${-r}L${0.3 * r} 0L${c} ${0.25 * r}` +
    `A${0.78 * r} ${0.78 * r} 0 0 1 ${-c} ${0.25 * r}L${-0.3 * r} 0Z`;
}

/** A rod that tapers from its big end to its small one. */
function rodOf([ax, ay], [bx, by], wide, narrow) {
  const long = Math.hypot(bx - ax, by - ay);
  const [nx, ny] = [-(by - ay) / long, (bx - ax) / long];
  const at = (x, y, side) => `${(x + side * nx).toFixed(1)} ${(y + side * ny).toFixed(1)}`;
  return `M${at(ax, ay, wide)}L${at(bx, by, narrow)}L${at(bx, by, -narrow)}L${at(ax, ay, -wide)}Z`;
}
