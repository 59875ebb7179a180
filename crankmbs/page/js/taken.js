/** The data of what is shown, as a file. */
import { general } from "./format.js";

/** Let the browser save a file. */
export function save(name, content) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/** Name and content of the data of a cycle, with names and units as in motion.csv. */
export function dataFile({ stem, units }, { samples }) {
  const { time: _, crank_angle: __, cylinders, ...crank } = samples[0];
  const columns = [["time [s]", (v) => v.time], ["crank_angle [rad]", (v) => v.crank_angle]];
  for (const name of Object.keys(crank)) columns.push([`${name} [${units[name]}]`, (v) => v[name]]);
  for (const name of Object.keys(cylinders[0])) {
    cylinders.forEach((each, k) => {
      columns.push([`${name} ${k + 1} [${units[name]}]`, (v) => v.cylinders[k][name]]);
    });
  }
  const lines = samples.map((v) => columns.map(([, of]) => general(of(v), 12)).join(","));
  const text = `${[columns.map(([name]) => name).join(","), ...lines].join("\n")}\n`;
  return [`${stem}.csv`, new Blob([text], { type: "text/csv" })];
}
