/** What can be taken away: the scene that is shown, as TOML with its tables, and its data. */
import { carriedAngle, isShape } from "./gas.js";
import { general } from "./format.js";
import { Toml } from "./toml.js";
import { zipped } from "./zip.js";

const DEGREE = Math.PI / 180;
const AROUND = 1e-9; // rad

/** Let the browser save a file. */
export function save(name, content) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/** Name and content of the scene: STEM.toml, or STEM.zip with its tables beside it. */
export function sceneFile(given, values, cycle) {
  const files = sceneFiles(given, values, cycle);
  const names = Object.keys(files);
  if (names.length > 1) return [`${given.stem}.zip`, zipped(files)];
  return [names[0], new Blob([files[names[0]]], { type: "application/toml" })];
}

/** The files of the scene at values of the knobs, { name: text }. */
export function sceneFiles(given, values, cycle) {
  const { scene } = cycle;
  const first = `${given.stem}.toml`;
  const files = { ...given.files };
  const toml = new Toml(files[first]);
  putMachine(toml, given, values, scene);
  const tables = { toml, files, given, scene, balance: cycle.share };
  if (scene.gas !== null) putGas(tables, values);
  if (scene.motion !== null && given.scene.motion === null) prescribe(tables);
  else if (scene.freed) setFree(toml, cycle);
  else putDrive(tables, values);
  if (cycle.why !== null) toml.put("[run]", "until", '"1 cycle"');
  if (scene.freed || (cycle.settled && cycle.motion.balanced)) putMotionShown(toml, cycle);
  const named = Object.entries(files).filter(([name]) => toml.text.includes(`"${name}"`));
  return { [first]: toml.text, ...Object.fromEntries(named) };
}

function putMachine(toml, given, values, { crank, rod, piston }) {
  const put = (heading, key, value, unit) => toml.put(heading, key, `"${value} ${unit}"`);
  if ("flywheel" in values) put("[crank]", "inertia", crank.inertia, "kg m^2");
  if ("counterweight" in values) put("[crank]", "center_of_mass", crank.center_of_mass, "m");
  if ("offset" in values) put("[piston]", "offset", piston.offset, "m");
  if (["rod_ratio", "rod_mass", "rod"].some((name) => name in values)) {
    put("[rod]", "length", rod.length, "m");
    put("[rod]", "mass", rod.mass, "kg");
    put("[rod]", "center_of_mass", rod.center_of_mass, "m");
    const lumped = (values.rod ?? (given.two_mass ? "two-mass" : "rigid")) === "two-mass";
    if (lumped) toml.put("[rod]", "inertia", '"two-mass"');
    else put("[rod]", "inertia", rod.inertia, "kg m^2");
  }
  if (values.cylinders !== undefined) {
    toml.dropSection("[layout]");
    toml.put("[layout]", "firing_order", `[${given.orders[values.cylinders].join(", ")}]`);
  }
}

/** Pressures that have moved or changed, as rows over the cycle angle. */
function putGas({ toml, files, given, scene }, values) {
  const { gas } = scene;
  const [{ radius }, { length }, { offset }] = [scene.crank, scene.rod, scene.piston];
  const shape = { radius, length, offset };
  const same = gas.shape === null || isShape(shape, gas.shape);
  if (same && !("pressure" in values)) return;
  const sources = { pressure: gas.fired };
  if (toml.get("[gas]", "motored") !== null) sources.motored = gas.motored;
  if (gas.below.length) sources.crank_end = gas.below;
  for (const [key, numbers] of Object.entries(sources)) {
    const kind = gas.sources[numbers[0]].kind;
    if (kind === "rows") putRows({ toml, files, given, gas, shape }, key, numbers);
    if (kind === "constant") {
      toml.put("[gas]", key, `"${gas.sources[numbers[0]].value + gas.ambient} Pa"`);
    }
    if (kind === "indicator") putDiagram(toml, gas.sources[numbers[0]]);
  }
}

function putRows({ toml, files, given, gas, shape }, key, numbers) {
  for (const each of ["zero", "aligned", "closing"]) toml.drop("[gas]", each);
  if (toml.get("[gas]", "cycles") === '"mean"') toml.drop("[gas]", "cycles");
  const names = numbers.map((number) => `${given.stem}_${key}${number + 1}.csv`);
  numbers.forEach((number, k) => {
    files[names[k]] = rowsText(gas.sources[number], gas, shape);
  });
  const one = names.every((name) => name === names[0]);
  toml.put("[gas]", key, one ? `"${names[0]}"` : `[${names.map((n) => `"${n}"`).join(", ")}]`);
}

function rowsText({ angle, value }, gas, shape) {
  const last = angle.length - 1;
  const turns = Math.round((angle[last] - angle[0]) / gas.period) * gas.period;
  const closes = Math.abs(angle[last] - angle[0] - turns) < AROUND && value[last] === value[0];
  const lines = ["crank_angle_deg,pressure_Pa"];
  for (let k = 0; k <= (closes ? last - 1 : last); k++) {
    const moved = gas.shape === null ? angle[k] : carriedAngle(angle[k], gas.shape, shape);
    lines.push(`${moved / DEGREE},${value[k] + gas.ambient}`);
  }
  return `${lines.join("\n")}\n`;
}

function putDiagram(toml, source) {
  const text = toml.get("[gas]", "indicator");
  const changed = text.replace(/(\w+_pressure) = "[^"]*"/g, (_, name) =>
    `${name} = "${source[name]} Pa"`);
  toml.put("[gas]", "indicator", changed);
}

/** A constant speed in place of start and loads. */
function prescribe({ toml, scene }) {
  toml.dropSection("[start]");
  while (toml.count("[[torque]]")) toml.dropSection("[[torque]]");
  const { angle, coefficients } = scene.motion;
  toml.put("[motion]", "speed", `"${coefficients[3]} rad/s"`);
  toml.put("[motion]", "angle", `"${angle} rad"`);
  toml.put("[run]", "until", '"1 cycle"');
}

/** A free crank under the load that balances it, in place of a prescribed speed. */
function setFree(toml, { scene, motion }) {
  toml.dropSection("[motion]");
  toml.drop("[run]", "formulation");
  toml.put("[crank]", "inertia", `"${scene.crank.inertia} kg m^2"`);
  toml.put("[start]", "angle", `"${scene.start.angle} rad"`);
  const [torque] = motion.train.loads[0].over_time.pieces;
  toml.put("[[torque]]", "kind", '"constant"');
  toml.put("[[torque]]", "torque", `"${torque} N m"`);
}

/** Where many motions repeat themselves, a period of that which is shown. */
function putMotionShown(toml, { scene, samples }) {
  toml.put("[start]", "speed", `"${samples[0].crank_speed} rad/s"`);
  const cycles = Math.round(scene.grid_period / scene.period);
  toml.put("[run]", "until", `"${cycles} cycle${cycles > 1 ? "s" : ""}"`);
}

function putDrive({ toml, files, given, scene, balance }, values) {
  let faster = 1;
  if ("speed" in values) {
    faster = speedOf(scene) / speedOf(given.scene);
    const speed = `"${speedOf(scene)} rad/s"`;
    if (scene.motion === null) toml.put("[start]", "speed", speed);
    else putMotion(toml, scene.motion, speed);
  }
  if (scene.motion !== null) return;
  const more = scene.cylinders.length / given.scene.cylinders.length;
  const share = ((values.load ?? 100) / 100) * more * balance;
  if (share === 1 && faster === 1) return;
  for (let n = 0; n < toml.count("[[torque]]"); n++) putLoad({ toml, files }, n, share, faster);
}

function speedOf({ motion, start }) {
  if (motion === null) return start.speed;
  return motion.kind === "oscillation" ? motion.mean : motion.coefficients.at(-1);
}

function putMotion(toml, motion, speed) {
  if (motion.kind !== "oscillation") {
    toml.put("[motion]", "speed", speed);
    return;
  }
  const swing = `amplitude = "${motion.amplitude} rad/s", order = ${motion.order}, ` +
    `phase = "${motion.phase} rad"`;
  toml.put("[motion]", "speed", `{ mean = ${speed}, ${swing} }`);
}

/** A load's share, the same torque at a speed so much higher. */
function putLoad({ toml, files }, n, share, faster) {
  const heading = "[[torque]]";
  const kind = toml.get(heading, "kind", n).slice(1, -1);
  const power = { viscous: 1, quadratic: 2 }[kind] ?? 0;
  for (const key of ["torque", "coefficient"]) {
    const text = toml.get(heading, key, n);
    if (text === null) continue;
    const [number, ...unit] = text.replaceAll('"', "").split(" ");
    const value = (Number(number) * share) / faster ** power;
    toml.put(heading, key, unit.length ? `"${value} ${unit.join(" ")}"` : value, n);
  }
  for (const key of ["from_speed", "until_speed"]) {
    const text = toml.get(heading, key, n);
    if (text === null) continue;
    const [number, unit] = text.slice(1, -1).split(" ");
    toml.put(heading, key, `"${Number(number) * faster} ${unit}"`, n);
  }
  const file = toml.get(heading, "file", n)?.slice(1, -1);
  if (file) files[file] = scaledRows(files[file], share, kind === "speed_table" ? faster : 1);
}

function scaledRows(text, share, faster) {
  const [head, ...rows] = text.trim().split("\n");
  const scaled = rows.map((row) => {
    const [x, y] = row.split(",").map(Number);
    return `${x * faster},${y * share}`;
  });
  return `${[head, ...scaled].join("\n")}\n`;
}

/** Name and content of the data of a cycle, with names and units as in motion.csv. */
export function dataFile({ stem, units }, { samples }) {
  const { time: _, crank_angle: __, cylinders, ...crank } = samples[0];
  const columns = [["time [s]", (v) => v.time], ["crank_angle [rad]", (v) => v.crank_angle]];
  for (const name of Object.keys(crank)) columns.push([`${name} [${units[name]}]`, (v) => v[name]]);
  for (const name of Object.keys(cylinders[0])) {
    cylinders.forEach((_, k) => {
      columns.push([`${name} ${k + 1} [${units[name]}]`, (v) => v.cylinders[k][name]]);
    });
  }
  const lines = samples.map((v) => columns.map(([, of]) => general(of(v), 12)).join(","));
  const text = `${[columns.map(([name]) => name).join(","), ...lines].join("\n")}\n`;
  return [`${stem}.csv`, new Blob([text], { type: "text/csv" })];
}
