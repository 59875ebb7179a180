/** Elements and paths of SVG. */

const SPACE = "http://www.w3.org/2000/svg";

/** A new element below another, with attributes. */
export function add(parent, tag, attributes = {}, text = null) {
  const made = document.createElementNS(SPACE, tag);
  set(made, attributes);
  if (text !== null) made.textContent = text;
  parent.append(made);
  return made;
}

export function set(element, attributes) {
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  return element;
}

/** The d of a line through points [x, y]; where one is no number the line is broken. */
export function pathOf(points, closed = false) {
  let d = "";
  let pen = "M";
  for (const [x, y] of points) {
    if (Number.isFinite(x) && Number.isFinite(y)) {
      d += `${pen}${Math.round(10 * x) / 10} ${Math.round(10 * y) / 10}`;
      pen = "L";
    } else {
      pen = "M";
    }
  }
  return closed ? `${d}Z` : d;
}

/** Call with the size of an element [px] and of its letters, now and whenever it changes. */
export function watched(element, changed) {
  new ResizeObserver(([{ contentRect: { width, height } }]) => {
    changed({ width, height, type: parseFloat(getComputedStyle(element).fontSize) });
  }).observe(element);
}
