/** What cells err, and which must be cut: a finer Gauss rule along the solution. */
import { torqueOf } from "./loads.js";
import { eachNode, integralTo } from "./rule.js";
import { givenAt } from "./tables.js";

const FINEST = 3e-14; // what rounding leaves of a cell
const MOST = 4; // parts of a cell at once

/** Into how many parts to cut every cell of a grid so that it errs, relatively, by no more than a
 * tolerance per radian at its end and by no more than the tolerance inside.
 *
 * finer : { rule, nodes } of the same cells for a rule of more stages
 */
export function partsOf(train, grid, finer, path, tolerance) {
  const worst = new Array(grid.edges.length - 1).fill(1);
  const stages = grid.rule.nodes.length;
  for (const cell of path.cells) {
    if (cell.number < 0) continue;
    const { atEnd, inside } = errorsOf(train, grid.rule, finer, cell);
    const end = (atEnd / Math.max(tolerance * Math.abs(cell.width), FINEST)) ** (0.5 / stages);
    const within = (inside / Math.max(tolerance, FINEST)) ** (1 / (stages + 1));
    const parts = Math.ceil(Math.max(end, within));
    worst[cell.number] = Math.max(worst[cell.number], Math.min(parts || 2, MOST));
  }
  return worst;
}

/** The largest relative error of energy and time of a cell, at its end and at the finer nodes. */
function errorsOf(train, rule, finer, cell) {
  const along = alongFiner(train, rule, finer, cell);
  const { rule: fine } = finer;
  const s = fine.nodes.length;
  const fastest = Math.max(...along.slowness.map((each) => 1 / each));
  const errors = [...fine.nodes, 1].map((x, j) => {
    const weight = (i) => (j < s ? fine.matrix[j * s + i] : fine.weights[i]);
    let [work, spent] = [0, 0];
    for (let i = 0; i < s; i++) {
      work += weight(i) * along.torque[i];
      spent += weight(i) * along.slowness[i];
    }
    const energy = Math.abs(cell.width * (work - integralTo(rule, cell.torque, cell.first, x)));
    const late = Math.abs(cell.width * (spent - integralTo(rule, cell.slowness, cell.first, x)));
    return energy / cell.energy + late * fastest;
  });
  return { atEnd: errors[s], inside: Math.max(...errors) };
}

/** Torque and slowness that the solution of a cell asks for at the nodes of the finer rule. */
function alongFiner(train, rule, finer, cell) {
  const { sense, branch, width } = cell;
  const torque = [];
  const slowness = [];
  eachNode(finer, cell.number, sense, (of, j) => {
    const x = finer.rule.nodes[j];
    const energy = cell.energy + width * integralTo(rule, cell.torque, cell.first, x);
    const time = cell.time + Math.abs(width) * integralTo(rule, cell.slowness, cell.first, x);
    const inertia = train.crank.inertia + of.inertia;
    const omega = sense * Math.sqrt((2 * Math.max(energy, 0)) / inertia);
    torque.push(givenAt(train, of, cell, omega) + torqueOf(branch, time, omega));
    slowness.push(sense / omega);
  });
  return { torque, slowness };
}
