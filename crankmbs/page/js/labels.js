/** Names of arrows, beside the mechanism: they never cover what they name; and of cylinders. */

export const LETTER = 0.6; // of the type: how wide a bold letter is
const APART = 1.25; // of the type, between names
const LEANS = 0.3; // sine of the angle at which names stand on one side of a cylinder

/** The box of a drawing, widened on the side to which the chosen cylinder leans, so that names of
 * so many letters stand beside it; and its scale [px]. size : of the svg; type : its letters [px];
 * lean : sine, to the right */
export function boxBeside({ left, top, width, height }, size, { letters, type, lean }) {
  const room = Math.abs(lean) > LEANS ? Math.min(LETTER * type * letters, 0.5 * size.width) : 0;
  const scale = Math.min((size.width - room) / width, size.height / height) || 1;
  const more = Math.max(2 * room - (size.width - scale * width), 0) / scale;
  return { left: lean < 0 ? left - more : left, top, width: width + more, height, scale };
}

/** Write names { name, kind, x, y of the arrow's end } to the left and right of a stage's drawing,
 * each with a line to its arrow; where there is little room, in two rows, or on the other side. */
export function namesBeside(pen, names, { type, edge, sides }) {
  const middle = 0.5 * (sides.left + sides.right);
  const room = { [-1]: sides.left - edge.left, 1: edge.right - sides.right };
  const wideOf = (rows) => LETTER * type * Math.max(...rows.map((row) => row.length));
  const rowsOf = (name, side) =>
    (wideOf([name]) <= room[side] ? [name] : name.split(/ (.*)/, 2));
  const sideOf = ({ name, x }) => {
    const side = x < middle - 0.1 * type ? -1 : 1;
    const fits = wideOf(rowsOf(name, side)) <= room[side] || room[-side] <= room[side];
    return fits ? side : -side;
  };
  for (const side of [-1, 1]) {
    const here = names.filter((each) => sideOf(each) === side);
    here.sort((one, two) => one.y - two.y);
    let least = edge.top + 1.2 * type;
    for (const { name, kind, x, y } of here) {
      const rows = rowsOf(name, side);
      const wide = wideOf(rows);
      const at = Math.max(y, least);
      const near = side > 0
        ? Math.min(sides.right, edge.right - wide)
        : Math.max(sides.left, edge.left + wide);
      pen.add("line", { x1: x, y1: y, x2: near - 0.3 * side * type, y2: at, class: kind });
      const place = { "text-anchor": side > 0 ? "start" : "end", x: near };
      rows.forEach((row, n) => {
        const below = (0.35 + n) * type;
        pen.add("text", { "font-size": type, class: kind, ...place, y: at + below }, row);
      });
      least = at + (APART + rows.length - 1) * type;
    }
  }
}

/** The chosen cylinder and others that stand beside it are drawn in full, the rest pale. */
export function looksOf({ cylinders }, k, chosen) {
  const apart = cylinders[k].bank !== cylinders[chosen].bank;
  const first = cylinders.findIndex(({ bank }) => bank === cylinders[k].bank) === k;
  if (k === chosen) return "cylinder chosen";
  return apart && first ? "cylinder" : "cylinder pale";
}

/** Which of several cylinders is chosen, and what is pale. */
export function whichOf(train, chosen) {
  const { length: count } = train.cylinders;
  const pale = train.cylinders.some((_, k) => looksOf(train, k, chosen) === "cylinder pale");
  const others = pale ? "; pale: the others" : "";
  return count > 1 ? `cylinder ${chosen + 1} of ${count}${others}` : "";
}
