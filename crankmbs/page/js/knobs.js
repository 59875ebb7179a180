/** Knobs: a slider without steps, with a number to type and its unit. */
import { refusalOf } from "./refused.js";
import { numberOf } from "./state.js";
import { build } from "./svg.js";

// a decimal comma, but for 1,200, which may be a thousand and two hundred
const COMMA = /^(?!\D*[1-9]\d{0,2},\d{3}\s*$)(\s*[+\u2212-]?\d*),(\d+\s*)$/;

export class Knobs {
  /** root : where they stand, its data-prefix before their ids; knobs : { name, label, unit, low,
   * high, value, decimals, about }; sentences : templates; first : names of those that the page
   * begins with, else all; on : { turn(name, value), release(), refuse(sentence) } */
  constructor(root, { knobs, sentences, first = null }, on) {
    this.rules = sentences;
    this.on = on;
    const begun = first?.map((name) => knobs.find((each) => each.name === name)) ?? knobs;
    const rest = knobs.filter((each) => !begun.includes(each));
    this.made = new Map([...begun, ...rest].map((knob) =>
      [knob.name, this.make(root, knob, rest.includes(knob) ? "knob rest" : "knob")]));
  }

  make(root, knob, kind) {
    const row = build(root, "div", kind);
    const label = build(row, "label");
    label.htmlFor = `${root.dataset.prefix ?? ""}knob-${knob.name}`;
    label.textContent = knob.label;
    const entry = build(row, "input", "entry");
    Object.assign(entry, { type: "text", inputMode: "decimal", autocomplete: "off" });
    entry.setAttribute("aria-label", `${knob.label}${knob.unit ? `, in ${knob.unit}` : ""}`);
    build(row, "span", "unit").textContent = knob.unit;
    const slider = build(row, "input", "slider");
    Object.assign(slider, { type: "range", min: knob.low, max: knob.high, step: "any" });
    slider.id = label.htmlFor;
    if (knob.about) row.title = knob.about;
    slider.addEventListener("input", () => this.turn(knob, Number(slider.value)));
    slider.addEventListener("change", () => this.on.release());
    slider.addEventListener("dblclick", () => {
      this.turn(knob, knob.value);
      this.on.release();
    });
    entry.addEventListener("change", () => this.type(knob, entry.value));
    const made = { row, slider, entry, knob };
    show(made, knob.value);
    return made;
  }

  turn(knob, value) {
    show(this.made.get(knob.name), value);
    this.on.turn(knob.name, value);
  }

  /** A number that was typed: the knob as it was, with the reason, where it cannot be. */
  type(knob, text) {
    const reason = refusalOf(() => {
      const labelled = { ...knob, name: knob.label };
      this.turn(knob, numberOf(text.replace(COMMA, "$1.$2"), labelled, this.rules));
      this.on.release();
    });
    if (reason === null) return;
    const unit = knob.unit && `, in ${knob.unit}`;
    this.on.refuse(`${reason}; type for example ${knob.value.toFixed(knob.decimals)}${unit}`);
  }

  /** Show the values that a state has, without turning. */
  show(values) {
    for (const [name, made] of this.made) show(made, values[name] ?? made.knob.value);
  }

  /** Leave knobs out of use that mean nothing at present. */
  disable(names) {
    for (const [name, { row, slider, entry }] of this.made) {
      const off = names.includes(name);
      row.classList.toggle("off", off);
      slider.disabled = entry.disabled = off;
    }
  }
}

function show({ slider, entry, knob }, value) {
  slider.value = value;
  entry.value = value.toFixed(knob.decimals);
  const text = `${entry.value} ${knob.unit}`.trim();
  slider.setAttribute("aria-valuetext", text);
}
