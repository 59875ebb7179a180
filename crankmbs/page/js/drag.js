/** Dragging the mechanism: what the pointer holds says at which crank angle it wants it, or how
 * heavy the flywheel. */
import { inertiaOfRim } from "./drawing.js";
import { strokeOf, throwAngles } from "./geometry.js";

const HAIR = 1e-6; // rad

/** Listen to a stage.
 *
 * on : { theta() now, turn(theta), rim(ratio), grip(held), release() }
 */
export function dragged(stage, on) {
  const { root } = stage;
  let held = null;
  root.addEventListener("pointerdown", (event) => {
    const grip = event.target.closest("[data-grip]");
    if (!grip) return;
    event.preventDefault();
    root.setPointerCapture?.(event.pointerId);
    const at = place(root, event);
    held = { kind: grip.dataset.grip, k: Number(grip.dataset.k ?? 0), id: event.pointerId };
    held.offset = offsetOf(stage, held, at, on.theta());
    root.classList.add("held");
    on.grip(held.kind);
  });
  root.addEventListener("pointermove", (event) => {
    if (held?.id !== event.pointerId) return;
    follow(stage, held, place(root, event), on);
  });
  const release = (event) => {
    if (held?.id !== event.pointerId) return;
    held = null;
    root.classList.remove("held");
    on.release();
  };
  root.addEventListener("pointerup", release);
  root.addEventListener("pointercancel", release);
}

/** Where the pointer is in the drawing's units. */
function place(root, { clientX, clientY }) {
  return new DOMPoint(clientX, clientY).matrixTransform(root.getScreenCTM().inverse());
}

/** The angle of a place about the crank axis, from X upwards to Y on the left [rad]. */
function angleOf({ x, y }) {
  return Math.atan2(-x, -y);
}

/** By how much what is held is away from the pointer: it must not jump. */
function offsetOf(stage, { kind, k }, at, theta) {
  if (kind === "rim") return Math.hypot(at.x, at.y) - 1000 * stage.sizes.rim;
  if (kind === "piston") return along(stage, k, at) - positionAt(stage.train, k, theta);
  return angleOf(at) - theta;
}

function follow(stage, held, at, on) {
  if (held.kind === "rim") {
    const rim = (Math.hypot(at.x, at.y) - held.offset) / 1000;
    on.rim(inertiaOfRim(Math.max(rim, 0.01 * stage.sizes.r), stage.sizes.r));
  } else if (held.kind === "piston") {
    on.turn(towards(stage, held.k, along(stage, held.k, at) - held.offset, on.theta()));
  } else {
    on.turn(on.theta() + nearest(angleOf(at) - held.offset - on.theta()));
  }
}

function positionAt({ gears, cylinders }, k, theta) {
  return gears[k].loop.at(theta + cylinders[k].phase).x;
}

/** A step of the crank without whole turns [rad]. */
function nearest(step) {
  return step - 2 * Math.PI * Math.round(step / (2 * Math.PI));
}

/** How far a place is along a cylinder [m]. */
function along(stage, k, { x, y }) {
  const { bank } = stage.train.cylinders[k];
  return (-y * Math.cos(bank) - x * Math.sin(bank)) / 1000;
}

/** The crank angle nearest to the present one at which the piston comes closest to a position; from
 * a dead centre the crank goes on. */
function towards({ train }, k, wanted, theta) {
  const { shape, top } = train.gears[k];
  const stroke = strokeOf(shape);
  const above = Math.min(Math.max(top - wanted, 0), stroke);
  const steps = throwAngles(above, stroke - above, shape)
    .map((angle) => nearest(angle - train.cylinders[k].phase - theta));
  const [on, back] = steps.sort((a, b) => b - a);
  return theta + (Math.abs(back) < Math.abs(on) - HAIR ? back : on);
}
