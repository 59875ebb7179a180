/** How heavy a flywheel must be for a fluctuation of the speed. */
import { filled } from "./format.js";
import { Refused } from "./refused.js";

const ROUNDS = 60;
const CLOSE = 1e-9; // of the fluctuation
const FARTHER = 2;

/** The inertia at which a fluctuation is met; `at` gives that of an inertia.
 *
 * It falls about as the inverse of the inertia: regula falsi on the product of both, which bends
 * little, with the older end halved where it would stay (Illinois). The bracket grows from the
 * knob's present value, as a light flywheel may not turn over at all.
 *
 * Raises Refused where the fluctuation is beyond what the knob's ends give.
 */
export function inertiaFor(wanted, at, { value, low, high }, sentence) {
  const missing = (inertia) => inertia * (at(inertia) - wanted);
  let [a, atA] = [value, missing(value)];
  const heavier = atA > 0;
  const end = heavier ? high : low;
  let [b, atB] = [a, atA];
  while (atB > 0 === heavier && atB !== 0) {
    if (b === end) {
      const fields = { what: heavier ? "least" : "most", percent: 100 * at(end) };
      throw new Refused(filled(sentence, { ...fields, end, came: 100 * wanted }));
    }
    [a, atA] = [b, atB];
    b = heavier ? Math.min(b * FARTHER, end) : Math.max(b / FARTHER, end);
    atB = missing(b);
  }
  return rootBetween(missing, [a, atA], [b, atB], CLOSE * wanted);
}

function rootBetween(f, [a, atA], [b, atB], close) {
  for (let n = 0; n < ROUNDS && atB !== 0; n++) {
    const c = (a * atB - b * atA) / (atB - atA);
    const atC = f(c);
    if (!(Math.abs(atC) > close * c)) return c;
    if (atC > 0 === atB > 0) {
      atA /= 2;
    } else {
      [a, atA] = [b, atB];
    }
    [b, atB] = [c, atC];
  }
  return b;
}
