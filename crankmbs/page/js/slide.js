/** A pointer that slides along a plot. */

const SLIP = 8; // px that a finger moves across before it slides: else it scrolls

/** Listen to an svg.
 *
 * on : { press(event) whether it is taken, move(event) of what is held, hover(event) of what is
 * not, release() }
 */
export function slid(svg, { press, move, hover, release }) {
  let [held, from] = [null, null];
  const follow = (event) => {
    if (held !== event.pointerId) return hover?.(event);
    if (from !== null && Math.abs(event.clientX - from) < SLIP) return null;
    from = null;
    return move(event);
  };
  svg.addEventListener("pointerdown", (event) => {
    if (!press(event)) return;
    event.preventDefault();
    svg.setPointerCapture?.(event.pointerId);
    held = event.pointerId;
    from = event.pointerType === "touch" ? event.clientX : null;
    follow(event);
  });
  svg.addEventListener("pointermove", follow);
  for (const end of ["pointerup", "pointercancel"]) {
    svg.addEventListener(end, (event) => {
      if (held !== event.pointerId) return;
      if (end === "pointerup") {
        from = null; // a tap moves, too
        follow(event);
      }
      held = null;
      release();
    });
  }
}
