/** A question: an answer is typed with its unit, and checked; what is near is not yet right. */

const NUMBER = /^([+-]?(?:\d+[.,]?\d*|[.,]\d+)(?:e[+-]?\d+)?)\s*(.*)$/i;

/** What a typed answer is worth: { verdict, text }, the verdict "right", "wrong" or "unclear".
 *
 * question : { value, unit, tolerance relative, units, hint } with the answer in `unit`, and units
 * that may be typed, each by its factor to `unit`
 */
export function judged(typed, { value, unit, tolerance, units, hint }) {
  const match = NUMBER.exec(typed.trim().replace(/[\u2212\u2013]/g, "-"));
  if (!match) {
    return { verdict: "unclear", text: `A number with its unit, please, such as 1.5 ${unit}.` };
  }
  const factor = units[plain(match[2])];
  if (factor === undefined) {
    const came = match[2] ? `“${match[2]}” is no unit of it` : "The unit is missing";
    return { verdict: "unclear", text: `${came}: answer in ${unit}.` };
  }
  const found = Number(match[1].replace(",", ".")) * factor;
  const off = Math.abs(found - value);
  if (off <= tolerance * Math.abs(value)) return { verdict: "right", text: "Right." };
  const text = off <= 5 * tolerance * Math.abs(value) ? `Close, but not there. ${hint}` : hint;
  return { verdict: "wrong", text };
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
