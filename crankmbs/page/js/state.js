/** What is shown, as the address keeps it: `#rod_ratio=0.35&rod=two-mass&angle=420`.
 *
 * An address is read as strictly as a knob: what cannot be is refused with the sentence that the
 * command line has for such a key.
 */
import { cut, filled, shown } from "./format.js";
import { Refused } from "./refused.js";

const NUMBER = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;

/** The number that a text is, between the ends of a knob; name : of its key. */
export function numberOf(text, { name, low, high }, rules) {
  const refuse = (kind, fields, came) => {
    throw new Refused(`${name}: ${filled(rules[kind], fields)}; ${came} came`);
  };
  const trimmed = text.trim().replace("\u2212", "-");
  if (/^[+-]?(inf|infinity|nan)$/i.test(trimmed)) refuse("finite_number", {}, trimmed);
  if (!NUMBER.test(trimmed)) refuse("float_type", {}, shown(text));
  const value = Number(trimmed);
  if (!Number.isFinite(value)) refuse("finite_number", {}, "inf");
  if (value < low) refuse("greater_than_equal", { ge: low }, cut(trimmed));
  if (value > high) refuse("less_than_equal", { le: high }, cut(trimmed));
  return value;
}

/** Reads and writes addresses of one page.
 *
 * keys : of everything that may be in an address: { name, low, high } of numbers, { name, words }
 * of choices; rules : templates of sentences
 */
export class Address {
  constructor(keys, rules) {
    this.keys = new Map(keys.map((key) => [key.name, key]));
    this.rules = rules;
  }

  /** The state that an address, with or without its #, says. */
  read(text) {
    const found = {};
    const parts = text.replace(/^#/, "").split("&").filter((part) => part !== "");
    for (const part of parts) {
      const [name, ...rest] = part.split("=");
      const key = this.keys.get(name);
      if (!key) throw new Refused(this.unknown(name));
      if (name in found) throw new Refused(`${name}: came twice; give it once`);
      found[name] = this.value(key, decoded(rest.join("=")));
    }
    return found;
  }

  value(key, text) {
    if (!key.words) return numberOf(text, key, this.rules);
    if (key.words.includes(text)) return text;
    const list = key.words.map((word) => `"${word}"`);
    const last = list.pop();
    const some = list.length ? `${list.join(", ")} or ${last}` : last;
    throw new Refused(`${key.name}: must be ${some}; ${shown(text)} came`);
  }

  unknown(name) {
    return `${cut(decoded(name))}: unknown key; known keys are ${[...this.keys.keys()].join(", ")}`;
  }

  /** The address of a state; numbers to their last digit. */
  write(state) {
    const parts = Object.entries(state).map(([name, value]) =>
      `${name}=${encodeURIComponent(String(value))}`);
    return `#${parts.join("&")}`;
  }
}

function decoded(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}
