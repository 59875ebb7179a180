/** Numbers and sentences as Python writes them, and as a reader likes them, and his units. */

export const RPM = Math.PI / 30; // rad/s
export const DEGREE = Math.PI / 180; // rad
export const MM = 1e-3; // m
export const KN = 1e3; // N

/** A number like Python's %g with so many digits. */
export function general(x, digits = 6) {
  if (x === 0 || !Number.isFinite(x)) return String(x).toLowerCase().replace("infinity", "inf");
  const [mantissa, exponent] = x.toExponential(digits - 1).split("e");
  const power = Number(exponent);
  if (power < -4 || power >= digits) {
    const sign = power < 0 ? "-" : "+";
    return `${trimmed(mantissa)}e${sign}${String(Math.abs(power)).padStart(2, "0")}`;
  }
  return trimmed(x.toFixed(Math.max(digits - 1 - power, 0)));
}

function trimmed(text) {
  return text.includes(".") ? text.replace(/\.?0+$/, "") : text;
}

/** A template of Python with its fields filled in, {name}, {name:g} or {name:.12g}. */
export function filled(template, values) {
  return template.replace(/\{(\w+)(?::(?:\.(\d+))?g)?\}/g, (field, name, digits) => {
    const value = values[name];
    return field.endsWith("g}") ? general(value, Number(digits ?? 6)) : String(value);
  });
}

/** A value as a message repeats it, cut to a readable length. */
export function shown(value) {
  return cut(JSON.stringify(value).split(/\s+/).join(" ").trim());
}

/** A text cut to a readable length. */
export function cut(text) {
  return text.length <= 60 ? text : `${text.slice(0, 56)} ...`;
}

/** A number to read: so many digits after the point, with a true minus sign. */
export function readable(x, decimals) {
  if (!Number.isFinite(x)) return "–";
  const text = x.toFixed(decimals);
  return Number(text) === 0 ? (0).toFixed(decimals) : text.replace("-", "\u2212");
}

/** A value with room for the longest of its curve, so that nothing beside it moves. */
export function padded(value, decimals, size) {
  const longest = readable(-size, decimals).length;
  return readable(value, decimals).padEnd(longest, "\u2007");
}

/** How many digits after the point show a size in four digits. */
export function decimalsFor(size) {
  if (!(size > 0)) return 0;
  return Math.min(Math.max(4 - Math.ceil(Math.log10(size)), 0), 9);
}

/** Round steps over a range, about so many: { ticks, step }. */
export function roundTicks(low, high, count) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((each) => each * power).find((each) => each >= rough * 0.999);
  return { ticks: steps(low, high, step), step };
}

/** The multiples of a step in a range. */
export function steps(low, high, step) {
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k <= high / step + 1e-9; k++) ticks.push(k * step);
  return ticks;
}

/** The largest of 1, 2, 5, 10, ... that is not above a number. */
export function roundBelow(x) {
  const power = 10 ** Math.floor(Math.log10(x));
  return [5, 2, 1].map((each) => each * power).find((each) => each <= x * 1.0000001) ?? power;
}
