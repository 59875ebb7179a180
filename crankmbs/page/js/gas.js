/** The gas: what pushes each piston over its cycle angle, gas force over the piston's area [Pa],
 * and what becomes of it when the geometry changes. Of a double-acting cylinder it is the pressure
 * of the head end less that of the crank end on its share of the area.
 *
 * Python passes the cubics of the shape that a scene has, and what they were made of. With another
 * shape the rows of a table move, so that the pressure stays a function of the swept fraction
 * within each stroke between the true dead centres, at the same compression ratio; a diagram of
 * polytropes is one of the volume already.
 */
import { countUpTo, distinct, once, recurring } from "./arrays.js";
import { joined, valueAt } from "./cubics.js";
import {
  Loop, bottomPosition, deadCentres, strokeOf, throwAngles, topPosition,
} from "./geometry.js";

const TURN = 2 * Math.PI;
const KNOT = 1e-9; // rad: two knots closer than this are one
// of the absolute pressure: how far cubics may be from a polytrope, as in Python, or on a screen
export const DIAGRAM = 1e-9;
export const SEEN = 1e-5;
const SUPPORT = [0, 0.25, 0.75, 1]; // Chebyshev's extrema: the ends are met exactly
const BETWEEN = [0.1, 0.5, 0.9]; // where a cubic through the support errs most

/** The cycles of the pressure of each cylinder, with fuel those without and with combustion; those
 * of the crank ends, if there are any.
 *
 * gas : as Python passes it, or null; shape : may differ from that of the scene, gas.shape, which
 * is null where cylinders are unlike, and then each keeps its own
 * share : of the piston's area, on which a crank end's pressure acts
 * closeness : of the absolute pressure, of cubics to a polytrope
 */
export function pressuresOf(gas, shape, share, closeness = DIAGRAM) {
  if (gas === null) return { pressure: [], firing: [], crank_end: [] };
  if (gas.shape === null || isShape(shape, gas.shape)) return gas;
  const close = { ...gas, closeness };
  const cycle = once((number) => cycleOf(close, gas.sources[number], shape));
  // cylinders of the same sources share what is made of them
  const made = once((sources) => {
    const [fired, motored, below] = JSON.parse(sources);
    const net = (head) => (below === null ? head : netOf(head, cycle(below), share));
    const head = cycle(fired);
    if (motored === null) return { pressure: net(head) };
    const unfired = cycleOf(close, gas.sources[motored], shape, head);
    return { pressure: net(unfired), firing: net(head) };
  });
  const all = gas.fired.map((fired, k) =>
    made(JSON.stringify([fired, gas.motored?.[k] ?? null, gas.below[k] ?? null])));
  return {
    pressure: all.map(({ pressure }) => pressure),
    firing: gas.motored === null ? [] : all.map(({ firing }) => firing),
    crank_end: gas.below.map(cycle),
  };
}

/** Whether one shape is another. */
export function isShape(one, other) {
  return ["radius", "length", "offset"].every((key) => one[key] === other[key]);
}

/** The pressure that a source stands for in a machine of this shape. */
function cycleOf(gas, source, shape, fired) {
  if (source.kind === "indicator") return diagram(gas, source, shape);
  if (source.kind === "polytrope") return continued(gas, source, shape, fired);
  if (source.kind === "constant") {
    return {
      knots: Float64Array.of(0, gas.period),
      coefficients: Float64Array.of(0, 0, 0, source.value),
    };
  }
  const angle = source.angle.map(carrying(gas.shape, shape));
  const last = angle.length - 1;
  angle[last] = angle[0] + (source.angle[last] - source.angle[0]);
  return joined({ ...source, angle }, source.interpolation);
}

/** The cycle angle [rad] in one machine at which the piston has swept the same fraction of the
 * same stroke as at a cycle angle in another, as a function of the latter. */
function carrying(from, to) {
  const centres = deadCentres(from);
  const swept = sweptIn(from);
  const stroke = strokeOf(to);
  return (phi) => {
    const turn = Math.floor((phi - centres.top) / TURN);
    const within = phi - turn * TURN;
    const part = swept(within);
    const [down, up] = throwAngles(part.fraction * stroke, part.rest * stroke, to);
    return (within <= centres.bottom ? down : up) + turn * TURN;
  };
}

/** Swept fraction of the stroke at a cycle angle and what is left of it, both exact where small:
 * x_top^2 - x^2 = 4 r l sin^2(psi / 2), x^2 - x_bottom^2 = 4 r l cos^2(psi / 2), with psi =
 * phi + beta. */
function sweptIn(shape) {
  const [loop, top, bottom] = [new Loop(shape), topPosition(shape), bottomPosition(shape)];
  const size = 4 * shape.radius * shape.length;
  return (phi) => {
    const at = loop.at(phi);
    const half = 0.5 * (phi + at.beta);
    const above = (size * Math.sin(half) ** 2) / (top + at.x);
    const below = (size * Math.cos(half) ** 2) / (at.x + bottom);
    return { fraction: above / (above + below), rest: below / (above + below) };
  };
}

/** An indicator diagram: compression p V^n, a rise at the firing dead centre, combustion at
 * constant pressure, expansion p V^n, and with four strokes intake and exhaust. */
function diagram(gas, source, shape) {
  const parts = strokesOf(gas, source, shape).map((stroke) => fitted(gas.closeness, ...stroke));
  const lefts = parts.flatMap((part) => part.lefts);
  const coefficients = [0, 1, 2, 3].flatMap((power) => {
    const gauge = power === 3 ? gas.ambient : 0;
    return parts.flatMap((part) => part.cubics.map((cubic) => cubic[power] - gauge));
  });
  const knots = Float64Array.from([...lefts, lefts[0] + gas.period]);
  return { knots, coefficients: Float64Array.from(coefficients) };
}

/** Begin, end [rad] and absolute pressure [Pa] of each smooth part of a diagram. */
function strokesOf(gas, source, shape) {
  const { top, bottom } = deadCentres(shape);
  const ratio = source.compression_ratio;
  const volume = relativeVolume(ratio, shape);
  const compression = (phi) =>
    source.intake_pressure * Math.pow(ratio / volume(phi), source.n_compression);
  const expansion = (phi) =>
    source.peak_pressure * Math.pow(source.pre_expansion / volume(phi), source.n_expansion);
  const fired = TURN + top;
  const closed = [[bottom, fired, compression]];
  let burnt = fired;
  if (source.fires && source.pre_expansion > 1) {
    const stroke = strokeOf(shape);
    const above = ((source.pre_expansion - 1) / (ratio - 1)) * stroke;
    burnt = TURN + throwAngles(above, stroke - above, shape)[0];
    closed.push([fired, burnt, () => source.peak_pressure]);
  }
  closed.push([burnt, TURN + bottom, source.fires ? expansion : compression]);
  if (gas.period < 1.5 * TURN) return closed;
  return [
    [top, bottom, () => source.intake_pressure],
    ...closed,
    [TURN + bottom, TURN + fired, () => source.exhaust_pressure],
  ];
}

/** V / V_clearance over the cycle angle, for a compression ratio. */
function relativeVolume(ratio, shape) {
  const loop = new Loop(shape);
  const top = topPosition(shape);
  const stroke = strokeOf(shape);
  return (phi) => 1 + ((ratio - 1) * (top - loop.at(phi).x)) / stroke;
}

/** The left knots and cubics of a smooth pressure: pieces are halved until each is good enough.
 *
 * Quarter turns are knots from the start: a rod no longer than radius + offset folds there. So are
 * those shared with another pressure.
 */
function fitted(closeness, begin, end, pressure, shared = []) {
  const quarter = 0.5 * Math.PI;
  const edges = [...shared];
  for (let k = Math.ceil(begin / quarter); k < Math.ceil(end / quarter); k++) {
    edges.push(k * quarter);
  }
  const inner = distinct(edges, KNOT).filter((each) => each > begin + KNOT && each < end - KNOT);
  const marks = [begin, ...inner, end];
  const open = [];
  for (let k = marks.length - 1; k > 0; k--) open.push([marks[k - 1], marks[k]]);
  const lefts = [];
  const cubics = [];
  while (open.length) {
    const [left, right] = open.pop();
    const cubic = throughSupport(left, right - left, pressure);
    if (right - left < KNOT || follows(cubic, left, right - left, pressure, closeness)) {
      lefts.push(left);
      cubics.push(cubic.map((each, k) => each / (right - left) ** (3 - k)));
    } else {
      const middle = 0.5 * (left + right);
      open.push([middle, right], [left, middle]);
    }
  }
  return { lefts, cubics };
}

function throughSupport(left, width, pressure) {
  const [y0, y1, y2, y3] = SUPPORT.map((s) => pressure(left + width * s));
  // divided differences
  const [first, middle, last] = [4 * (y1 - y0), 2 * (y2 - y1), 4 * (y3 - y2)];
  const [near, far] = [(middle - first) / 0.75, (last - middle) / 0.75];
  const a = far - near;
  return [a, near - a, first - 0.25 * near + 0.1875 * a, y0];
}

function follows([a, b, c, d], left, width, pressure, closeness) {
  return BETWEEN.every((s) => {
    const exact = pressure(left + width * s);
    return Math.abs(((a * s + b) * s + c) * s + d - exact) <= closeness * exact;
  });
}

/** A fired pressure, from where it closes to the true bottom dead centre a polytrope in its place,
 * in every cycle. */
function continued(gas, source, shape, fired) {
  const volume = relativeVolume(source.compression_ratio, shape);
  const { top, bottom } = deadCentres(shape);
  const first = TURN + top + source.closes;
  const length = bottom - top - source.closes;
  const period = fired.knots[fired.knots.length - 1] - fired.knots[0];
  const knots = [];
  const parts = [];
  for (let at = first; at < first + period - 1e-6; at += gas.period) {
    const pressed = valueAt(fired, at) + gas.ambient;
    const size = volume(at);
    const rows = gas.closeness < SEEN ? knotsBetween(fired, at, at + length) : [];
    const pressure = (phi) => pressed * Math.pow(size / volume(phi), source.polytrope);
    const part = fitted(gas.closeness, at, at + length, pressure, rows);
    parts.push({ ...part, begin: knots.length });
    knots.push(...part.lefts, ...knotsBetween(fired, at + length, at + gas.period).slice(0, -1));
  }
  knots.push(first + period);
  const found = cycleOn(fired, Float64Array.from(knots));
  for (const { begin, cubics } of parts) {
    cubics.forEach((cubic, k) => cubic.forEach((c, power) => {
      const to = power * (knots.length - 1) + begin + k;
      found.coefficients[to] = power === 3 ? c - gas.ambient : c;
    }));
  }
  return found;
}

/** A cycle less a share of another, on the knots of both over their least common period. */
function netOf(one, other, share) {
  const [first] = one.knots;
  const turns = [one, other].map(({ knots }) => Math.round((knots.at(-1) - knots[0]) / TURN));
  let common = turns[0];
  while (common % turns[1]) common += turns[0];
  const last = first + common * TURN;
  const marks = [one, other].flatMap((cycle) => knotsBetween(cycle, first, last));
  const knots = distinct([...marks.filter((mark) => mark < last - KNOT), last], KNOT);
  const { coefficients: less } = cycleOn(other, knots);
  const { coefficients: of } = cycleOn(one, knots);
  return { knots, coefficients: of.map((c, k) => c - share * less[k]) };
}

function knotsBetween(cycle, low, high) {
  const { knots } = cycle;
  const all = recurring(knots.slice(1), knots.at(-1) - knots[0], low, high);
  return [low, ...distinct(all.filter((each) => each > low && each < high), 0), high];
}

/** A cycle with other knots, between each two of which lies one piece. */
function cycleOn({ knots: own, coefficients: of }, knots) {
  const n = own.length - 1;
  const m = knots.length - 1;
  const period = own[n] - own[0];
  const coefficients = new Float64Array(4 * m);
  let piece = n;
  for (let k = 0; k < m; k++) {
    const middle = 0.5 * (knots[k] + knots[k + 1]);
    const within = middle - Math.floor((middle - own[0]) / period) * period;
    if (piece === n || within < own[piece]) piece = countUpTo(own, within, 1, n) - 1;
    while (piece + 1 < n && own[piece + 1] <= within) piece++;
    const x = within - own[piece] - (middle - knots[k]);
    const [a, b, c, d] = [of[piece], of[n + piece], of[2 * n + piece], of[3 * n + piece]];
    coefficients[k] = a;
    coefficients[m + k] = b + 3 * a * x;
    coefficients[2 * m + k] = c + (2 * b + 3 * a * x) * x;
    coefficients[3 * m + k] = d + (c + (b + a * x) * x) * x;
  }
  return { knots, coefficients };
}
