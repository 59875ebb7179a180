/** What Python writes into a page. */

/** Values as Python wrote them, arrays from base64 doubles; seen : the different ones so far. */
export function valuesOf(value, seen = []) {
  if (Array.isArray(value)) return value.map((each) => valuesOf(each, seen));
  if (value === null || typeof value !== "object") return value;
  if ("again" in value) return seen[value.again];
  if ("f64" in value) {
    const bytes = Uint8Array.from(atob(value.f64), (letter) => letter.charCodeAt(0));
    return seen[seen.push(new Float64Array(bytes.buffer)) - 1];
  }
  return Object.fromEntries(
    Object.entries(value).map(([key, each]) => [key, valuesOf(each, seen)]));
}
