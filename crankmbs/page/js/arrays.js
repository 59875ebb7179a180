/** Small helpers on numbers and arrays that know nothing of cranks. */

const HAIR = 1e-9; // of a period

/** x modulo a period, from 0 up to it, also for negative x. */
export function wrapped(x, period) {
  const rest = x % period;
  return rest < 0 ? rest + period : rest;
}

/** Angles of every turn, or of every `own` period, over a period from 0 up to it [rad]. */
export function repeated(angles, period, own = 2 * Math.PI) {
  const found = [];
  for (let turn = 0; turn < period - 1; turn += own) {
    for (const angle of angles) found.push(wrapped(angle + turn, period));
  }
  return found;
}

/** Angles that come again after every period, as often as they lie from one angle to another. */
export function recurring(angles, period, from, to) {
  const [low, high] = [Math.min(from, to), Math.max(from, to) + HAIR * period];
  const found = [];
  for (let k = 0; k < angles.length; k++) {
    const first = Math.ceil((low - angles[k]) / period - HAIR);
    for (let n = first; angles[k] + n * period <= high; n++) found.push(angles[k] + n * period);
  }
  return found;
}

/** How many of increasing values, from number `low` up to `high`, are not above x. */
export function countUpTo(values, x, low = 0, high = values.length) {
  while (low < high) {
    const middle = (low + high) >> 1;
    if (values[middle] <= x) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Solve a small linear system in place, with pivoting.
 *
 * matrix : n x n, row by row; right : n x m, row by row, becomes the m answers
 */
export function eliminate(matrix, right, n, m) {
  for (let j = 0; j < n; j++) {
    let pivot = j;
    for (let i = j + 1; i < n; i++) {
      if (Math.abs(matrix[i * n + j]) > Math.abs(matrix[pivot * n + j])) pivot = i;
    }
    if (pivot !== j) {
      swapRows(matrix, j, pivot, n);
      swapRows(right, j, pivot, m);
    }
    for (let i = j + 1; i < n; i++) {
      const factor = matrix[i * n + j] / matrix[j * n + j];
      for (let k = j + 1; k < n; k++) matrix[i * n + k] -= factor * matrix[j * n + k];
      for (let k = 0; k < m; k++) right[i * m + k] -= factor * right[j * m + k];
    }
  }
  for (let j = n - 1; j >= 0; j--) {
    for (let k = 0; k < m; k++) {
      let rest = right[j * m + k];
      for (let i = j + 1; i < n; i++) rest -= matrix[j * n + i] * right[i * m + k];
      right[j * m + k] = rest / matrix[j * n + j];
    }
  }
}

function swapRows(matrix, a, b, width) {
  const kept = matrix.slice(a * width, (a + 1) * width);
  for (let k = 0; k < width; k++) matrix[a * width + k] = matrix[b * width + k];
  for (let k = 0; k < width; k++) matrix[b * width + k] = kept[k];
}

/** A root of a function that is below 0 at one place and not below at a later one, by halving. */
export function rootIn(f, low, high) {
  if (f(low) >= 0) return low;
  for (let n = 0; n < 60 && high - low > 1e-16; n++) {
    const middle = 0.5 * (low + high);
    if (f(middle) >= 0) high = middle;
    else low = middle;
  }
  return high;
}

/** Where a rising function is 0, by Newton's method within [low, high] from x on; f : value and
 * slope at a place; hair : of a place, its rounding. */
export function rootOf(f, [low, high], x, hair) {
  for (let n = 0; n < 100; n++) {
    const [value, slope] = f(x);
    if (value > 0) high = x;
    else low = x;
    let next = x - value / slope;
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    if (Math.abs(next - x) <= hair(next)) return next;
    x = next;
  }
  return x;
}

/** A sum that keeps what each step loses by rounding (Neumaier). */
export class Sum {
  constructor(value = 0) {
    this.rounded = value;
    this.lost = 0;
  }

  add(term) {
    const total = this.rounded + term;
    const larger = Math.abs(this.rounded) >= Math.abs(term);
    this.lost += larger ? this.rounded - total + term : term - total + this.rounded;
    this.rounded = total;
  }

  get value() {
    return this.rounded + this.lost;
  }
}

/** Values of increasing order without those that repeat within a hair. */
export function distinct(values, hair) {
  const found = new Float64Array(values).sort();
  let [count, before] = [0, -Infinity];
  for (const value of found) {
    if (value - before > hair) found[count++] = value;
    before = value;
  }
  return found.slice(0, count);
}

/** A function that computes its answer to each argument once. */
export function once(compute) {
  const answers = new Map();
  return (given) => {
    if (!answers.has(given)) answers.set(given, compute(given));
    return answers.get(given);
  };
}

/** The function, which remembers its last answer and gives it again for the same arguments, or for
 * those of which `key` gives the same.
 *
 * They are compared as objects, lists of them each by each: what is new must be a new object.
 */
export function remembering(compute, key = (...given) => given) {
  let before = null;
  let answer = null;
  return (...given) => {
    const now = key(...given);
    if (before === null || !isSame(now, before)) {
      answer = compute(...given);
      before = now;
    }
    return answer;
  };
}

/** Whether two values, or lists of them each by each, are the same objects. */
export function isSame(a, b) {
  if (a === b) return true;
  const lists = Array.isArray(a) && Array.isArray(b) && a.length === b.length;
  return lists && a.every((each, k) => isSame(each, b[k]));
}
