/** A question: an answer is typed, in the unit shown or with its own, and checked; what is near is
 * not yet right. */

const NUMBER = /^([+-]?(?:\d+[.,]?\d*|[.,]\d+)(?:e[+-]?\d+)?)\s*(.*)$/i;

/** What a typed answer is worth: { verdict, text }, the verdict "right", "wrong" or "unclear".
 *
 * question : { values that are right in `unit`, unit, tolerance relative, units, hint }, with units
 * that may be typed, each by its factor to `unit`
 */
export function judged(typed, { values, unit, tolerance, units, hint }) {
  const match = NUMBER.exec(typed.trim().replace(/[\u2212\u2013]/g, "-"));
  const shown = unit && `\u00a0${unit}`;
  if (!match) return { verdict: "unclear", text: `A number, please, such as 1.5${shown}.` };
  const factor = match[2] ? units[plain(match[2])] : 1;
  if (factor === undefined) {
    const wanted = unit ? `in ${unit}` : "by a number without a unit";
    return { verdict: "unclear", text: `“${match[2]}” does not fit here: answer ${wanted}.` };
  }
  const found = Number(match[1].replace(",", ".")) * factor;
  const awayOf = (number) => Math.min(...values.map((value) => Math.abs(number / value - 1)));
  const off = awayOf(found);
  if (off <= tolerance) return { verdict: "right", text: "Right." };
  if (unit === "%" && !match[2] && awayOf(100 * found) <= tolerance) {
    return { verdict: "unclear", text: "In %, please." };
  }
  return { verdict: "wrong", text: off <= 5 * tolerance ? `Close, but not there. ${hint}` : hint };
}

/** A unit without what may be written one way or the other. */
function plain(unit) {
  return unit.replace(/[\s^*·]/g, "").replace("²", "2").replace("deg", "°");
}

/** Listen to a question's field and button. */
export function asked(root, question) {
  const [field, button] = [root.querySelector("input"), root.querySelector("button")];
  const reply = root.querySelector(".reply");
  const check = () => {
    const { verdict, text } = judged(field.value, question);
    reply.textContent = text;
    reply.className = `reply ${verdict}`;
    if (verdict === "right") root.querySelector("details").open = true;
  };
  button.addEventListener("click", check);
  field.addEventListener("keydown", (event) => event.key === "Enter" && check());
}
