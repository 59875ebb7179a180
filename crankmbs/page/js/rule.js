/** Gauss collocation on the unit interval. The numbers of a rule come from Python:
 * nodes, weights (s), matrix (s x s, integrals of the Lagrange polynomials from 0 to each node)
 * and to_legendre (s x s, node values to coefficients of shifted Legendre polynomials).
 */

import { eliminate } from "./arrays.js";

/** Integral from 0 to x of the polynomial through values at the nodes, of which those from
 * number `first` on are meant. */
export function integralTo(rule, values, first, x) {
  const stages = rule.nodes.length;
  const z = 2 * x - 1;
  let before = 1;
  let legendre = z;
  let integral = coefficient(rule, values, first, 0) * x;
  for (let j = 1; j < stages; j++) {
    const after = ((2 * j + 1) * z * legendre - j * before) / (j + 1);
    integral += (coefficient(rule, values, first, j) * (after - before)) / (4 * j + 2);
    before = legendre;
    legendre = after;
  }
  return integral;
}

/** Coefficient of the shifted Legendre polynomial of degree j. */
function coefficient(rule, values, first, j) {
  const stages = rule.nodes.length;
  let sum = 0;
  for (let i = 0; i < stages; i++) sum += rule.to_legendre[j * stages + i] * values[first + i];
  return sum;
}

/** Solves cells of dE/dtheta = push + rate E. */
export class LinearCell {
  constructor(rule) {
    const s = rule.nodes.length;
    this.rule = rule;
    [this.system, this.found] = [new Float64Array(s * s), new Float64Array(2 * s)];
  }

  /** The energies at the nodes of a cell, each as gain and shift of that at its begin, E_j =
   * gain E + shift; push and rate begin at number `first`. */
  solve(width, push, rate, first = 0) {
    const { rule: { matrix, nodes: { length: s } }, system, found } = this;
    for (let j = 0; j < s; j++) {
      found[2 * j] = 1;
      found[2 * j + 1] = 0;
      for (let i = 0; i < s; i++) {
        const part = width * matrix[j * s + i];
        system[j * s + i] = (i === j ? 1 : 0) - part * rate[first + i];
        found[2 * j + 1] += part * push[first + i];
      }
    }
    eliminate(system, found, s, 2);
    return found;
  }
}

/** The angles of the nodes in every cell between edges [rad]. */
export function nodesBetween(edges, rule) {
  const stages = rule.nodes.length;
  const angles = new Float64Array((edges.length - 1) * stages);
  for (let k = 0; k + 1 < edges.length; k++) {
    const width = edges[k + 1] - edges[k];
    for (let j = 0; j < stages; j++) angles[k * stages + j] = edges[k] + width * rule.nodes[j];
  }
  return angles;
}

/** Visit the nodes of a cell of a grid in the order in which a sense of rotation passes, with what
 * is there and the number of each. */
export function eachNode({ rule, nodes }, number, sense, visit) {
  const stages = rule.nodes.length;
  const first = number * stages;
  for (let j = 0; j < stages; j++) visit(nodes.at(first + (sense > 0 ? j : stages - 1 - j)), j);
}
