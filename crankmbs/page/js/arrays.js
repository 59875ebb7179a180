/** Small helpers on numbers and arrays that know nothing of cranks. */

/** x modulo a period, from 0 up to it, also for negative x. */
export function wrapped(x, period) {
  const rest = x % period;
  return rest < 0 ? rest + period : rest;
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
  for (let k = 0; k < width; k++) {
    const kept = matrix[a * width + k];
    matrix[a * width + k] = matrix[b * width + k];
    matrix[b * width + k] = kept;
  }
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
  const sorted = Float64Array.from(values).sort();
  return sorted.filter((value, k) => k === 0 || value - sorted[k - 1] > hair);
}

/** The function, which remembers its last answer and gives it again for the same arguments.
 *
 * Arguments are compared as objects, lists of them each by each: what is new must be a new object.
 */
export function remembering(compute) {
  let before = null;
  let answer = null;
  return (...given) => {
    if (before === null || !isSame(given, before)) {
      answer = compute(...given);
      before = given;
    }
    return answer;
  };
}

function isSame(a, b) {
  if (a === b) return true;
  const lists = Array.isArray(a) && Array.isArray(b) && a.length === b.length;
  return lists && a.every((each, k) => isSame(each, b[k]));
}
