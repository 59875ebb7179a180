/** Outlines of what is drawn of the mechanism, as the d of paths. */

/** An arrow from a place by a step, of a half width. */
export function arrowOf(x, y, dx, dy, half) {
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
export function webOf(r) {
  const [w, c] = [0.24 * r, 0.72 * r];
  return `M${-w} ${-r}A${w} ${w} 0 0 1 ${w} ${-r}L${0.3 * r} 0L${c} ${0.25 * r}` +
    `A${0.78 * r} ${0.78 * r} 0 0 1 ${-c} ${0.25 * r}L${-0.3 * r} 0Z`;
}

/** A rod of a length that tapers from its big end down to its small one, the latter at 0. */
export function rodOf(length, wide, narrow) {
  return `M${-narrow} 0H${narrow}L${wide} ${length}H${-wide}Z`;
}
