/** Gauss collocation on the unit interval. The numbers of a rule come from Python:
 * nodes, weights (s), matrix (s x s, integrals of the Lagrange polynomials from 0 to each node)
 * and to_legendre (s x s, node values to coefficients of shifted Legendre polynomials).
 */

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

/** Fill a matrix with that of E - width A (rate E) in a cell; its rates begin at number `first`. */
export function fillSystem(system, { matrix, nodes: { length: s } }, width, rate, first = 0) {
  for (let j = 0; j < s; j++) {
    for (let i = 0; i < s; i++) {
      system[j * s + i] = (i === j ? 1 : 0) - width * matrix[j * s + i] * rate[first + i];
    }
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
