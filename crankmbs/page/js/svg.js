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

/** A new element of HTML below another. */
export function build(parent, tag, className = "") {
  return parent.appendChild(Object.assign(document.createElement(tag), { className }));
}

/** So many elements below another, each [tag, class] with the same parts. */
export function listed(parent, count, made, parts) {
  while (parent.children.length > count) parent.lastChild.remove();
  while (parent.children.length < count) {
    const item = build(parent, ...made);
    for (const tag of parts) build(item, tag);
  }
  return parent.children;
}

/** Set attributes; those that it set so already are let alone, as others would be parsed anew. */
export function set(element, attributes) {
  const own = (element.shown ??= {});
  for (const name in attributes) {
    if (own[name] === attributes[name]) continue;
    own[name] = attributes[name];
    element.setAttribute(name, own[name]);
  }
  return element;
}

/** Write a text into an element that holds nothing else, in the node that is there: a new one would
 * be styled and laid out anew. */
export function write(element, text) {
  const { firstChild: node } = element;
  if (node === null) element.textContent = text;
  else if (node.data !== text) node.data = text;
}

/** The transform that turns counter-clockwise by an angle [rad]. */
export function turn(angle) {
  return `rotate(${(-angle * 180) / Math.PI})`;
}

/** Draws into a group over what it drew there before. */
export class Pen {
  constructor(group) {
    this.group = group;
    this.count = 0;
  }

  /** The next element; one of a tag has always the same attributes. */
  add(tag, attributes, text = null) {
    let each = this.group.children[this.count++];
    if (each?.tagName !== tag) {
      const made = add(this.group, tag);
      each?.replaceWith(made);
      each = made;
    }
    if (text !== null) write(each, text);
    return set(each, attributes);
  }

  /** Take away what was drawn there before and is no more. */
  end() {
    while (this.group.children.length > this.count) this.group.lastChild.remove();
  }
}

/** The d of a line through { x, y } in tenths of a pixel, right and up being maps to pixels: steps
 * in whole numbers, which are short and so quickly read. It leaves out points that lie on the line
 * to within two tenths; where one is no number the line is broken. */
export function lineOf({ x, y }, { right, up }) {
  let d = "";
  let [fromX, fromY] = [NaN, NaN]; // the last point drawn
  let [lastX, lastY] = [NaN, NaN]; // the last point seen
  let [low, high] = [-Infinity, Infinity]; // slopes on which all points since are met
  const draw = () => {
    const begun = Number.isFinite(fromX + fromY);
    if (Number.isFinite(lastX + lastY)) {
      d += begun ? `l${lastX - fromX} ${lastY - fromY}` : `M${lastX} ${lastY}`;
    }
    [fromX, fromY, low, high] = [lastX, lastY, -Infinity, Infinity];
  };
  for (let k = 0; k < x.length; k++) {
    const atX = Math.round(10 * right(x[k]));
    const atY = Math.round(10 * up(y[k]));
    const slope = (atY - fromY) / (atX - fromX);
    if (!(atX > lastX && slope >= low && slope <= high) && k > 0) draw();
    lastX = atX;
    lastY = atY;
    const wide = lastX - fromX;
    if (wide > 0) {
      low = Math.max(low, (lastY - 2 - fromY) / wide);
      high = Math.min(high, (lastY + 2 - fromY) / wide);
    } else {
      low = Infinity; // straight up or back: whatever comes next is another line
    }
  }
  draw();
  return d;
}

/** Call with the size of an element [px] and of its letters, now and whenever it changes. */
export function watched(element, changed) {
  new ResizeObserver(([{ contentRect: { width, height } }]) => {
    changed({ width, height, type: parseFloat(getComputedStyle(element).fontSize) });
  }).observe(element);
}
