/** What every page with a film or a cycle has: its elements, its keys, large type. */

export function find(id) {
  return document.getElementById(id);
}

/** Listen to the keyboard where nothing else takes it: space plays, arrows step, others by name.
 *
 * on : { play(), step(-1 or 1, whether with shift), Home() and so on }
 */
export function listenToKeys(on) {
  const steps = { ArrowLeft: -1, ArrowRight: 1, ArrowDown: -1, ArrowUp: 1 };
  document.addEventListener("keydown", (event) => {
    if (event.target.closest("input, select, button")) return;
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === " ") on.play();
    else if (event.key in steps) on.step(steps[event.key], event.shiftKey);
    else if (event.key in on) on[event.key]();
    else return;
    event.preventDefault();
  });
}

/** Large type for a projector, or no longer. */
export function enlarge({ target }) {
  const on = document.documentElement.classList.toggle("projector");
  target.setAttribute("aria-pressed", String(on));
}
