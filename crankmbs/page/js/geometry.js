/** Loop closure of the slider-crank with offset, exact:
 *
 *     l sin(beta) = r sin(phi) - e,    x = r cos(phi) + l cos(beta)
 *
 * phi is the cycle angle of one cylinder; a suffix 1 or 2 is a derivative in phi. A shape is
 * { radius, length, offset } [m] with length >= radius + |offset|.
 */

/** The closed loop at one cycle angle after the other; `at` fills the fields. */
export class Loop {
  constructor(shape) {
    const { radius, length, offset } = shape;
    Object.assign(this, { radius, length, offset });
    this.spare = Math.max(length - radius - Math.abs(offset), 0);
    this.phi = NaN;
    this.sinPhi = this.cosPhi = this.sinBeta = this.cosBeta = 0.5;
    this.beta1 = this.beta2 = this.x = this.x1 = this.x2 = 0.5;
  }

  /** Close the loop at a cycle angle [rad]; also near the fold of a short rod to rounding. */
  at(phi) {
    if (phi === this.phi) return this; // as the forces at a sample ask for what its motion had
    const { radius: r, length: l, offset: e, spare } = this;
    const sinPhi = Math.sin(phi);
    const cosPhi = Math.cos(phi);
    const sinBeta = (r * sinPhi - e) / l;
    // 1 - sin(phi) and 1 + sin(phi): the smaller from their product, as it would cancel near a fold
    const wide = 1 + Math.abs(sinPhi);
    const narrow = (cosPhi * cosPhi) / wide;
    const above = sinPhi > 0 ? narrow : wide;
    const below = sinPhi > 0 ? wide : narrow;
    const far = Math.abs(e);
    const cosBeta = Math.sqrt((spare + far + e + r * above) * (spare + far - e + r * below)) / l;
    const beta1 = (r * cosPhi) / (l * cosBeta);
    // -l cos(beta)^3 beta2 / r as a sum of terms that are themselves small near a fold
    const towards = (e >= 0 ? below : above) / l;
    const bend = sinPhi * (spare / l) * (1 + (r + far) / l) + e * r * towards * towards;
    const beta2 = (-r * bend) / (l * cosBeta * cosBeta * cosBeta);
    this.phi = phi;
    this.sinPhi = sinPhi;
    this.cosPhi = cosPhi;
    this.sinBeta = sinBeta;
    this.cosBeta = cosBeta;
    this.beta1 = beta1;
    this.beta2 = beta2;
    this.x = r * cosPhi + l * cosBeta;
    this.x1 = -r * sinPhi - l * sinBeta * beta1;
    this.x2 = -r * cosPhi - l * (cosBeta * beta1 * beta1 + sinBeta * beta2);
    return this;
  }

  /** Rod angle [rad]. */
  get beta() {
    return Math.atan2(this.sinBeta, this.cosBeta);
  }
}

/** Cycle angles [rad] of the true dead centres: sin(top) = e / (l + r),
 * bottom = pi + asin(e / (l - r)). */
export function deadCentres({ radius, length, offset }) {
  const spare = length - radius;
  const beyond = spare > 0 ? Math.asin(Math.min(Math.max(offset / spare, -1), 1)) : 0;
  return { top: Math.asin(offset / (length + radius)), bottom: Math.PI + beyond };
}

/** Piston pin position [m] at the true top dead centre: sqrt((l + r)^2 - e^2). */
export function topPosition({ radius, length, offset }) {
  return Math.sqrt((length + radius - offset) * (length + radius + offset));
}

/** Piston pin position [m] at the true bottom dead centre. */
export function bottomPosition(shape) {
  return new Loop(shape).at(deadCentres(shape).bottom).x;
}

/** Between the true dead centres [m]. */
export function strokeOf(shape) {
  return topPosition(shape) - bottomPosition(shape);
}

/** The angle [rad] by which the throw leads the direction of the piston pin at x, opposite the rod;
 * above, below [m] : how far the pin is from its dead centres. */
function leadAt(x, above, below, { radius, length, offset }) {
  const distance = Math.hypot(x, offset);
  const top = x + above;
  const bottom = x - below;
  const nearTop = (above * (top + x)) / (radius + length + distance);
  const nearBottom = (below * (bottom + x)) / (distance + length - radius);
  const over = nearTop * (length + distance - radius);
  const under = nearBottom * (radius + distance + length);
  return 2 * Math.atan2(Math.sqrt(Math.max(over, 0)), Math.sqrt(Math.max(under, 0)));
}

/** Cycle angles [rad] at which the piston is so far from its dead centres [m], on the way to the
 * crank and, less than a turn later, on the way back. */
export function throwAngles(above, below, shape) {
  const x = topPosition(shape) - above;
  const along = Math.atan2(shape.offset, x);
  const lead = leadAt(x, above, below, shape);
  return [along + lead, along - lead + 2 * Math.PI];
}

/** The radius, rod and piston of every cylinder: its own, or those that all have. */
export function runningGear({ crank, rod, piston, cylinders }) {
  return cylinders.map(({ own }) => own ?? { radius: crank.radius, rod, piston });
}

export function shapeOf({ radius, rod, piston }) {
  return { radius, length: rod.length, offset: piston.offset };
}

/** A vector from a cylinder's frame in the engine's. */
export function turnedBy(bank, x, y) {
  if (bank === 0) return [x, y];
  const [cos, sin] = [Math.cos(bank), Math.sin(bank)];
  return [cos * x - sin * y, sin * x + cos * y];
}
