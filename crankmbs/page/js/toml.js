/** A scene's TOML as Python wrote it, changed key by key. */

export class Toml {
  constructor(text) {
    this.lines = text.split("\n");
  }

  get text() {
    return `${this.lines.join("\n").trim()}\n`;
  }

  /** First line of a section's keys, and the line after its last; null where it is not there.
   * number : of the section among those of one heading */
  range(heading, number = 0) {
    let k = -1;
    for (let n = 0; n <= number; n++) k = this.lines.indexOf(heading, k + 1);
    if (k < 0) return null;
    let end = k + 1;
    while (end < this.lines.length && !this.lines[end].startsWith("[")) end++;
    while (end > k + 1 && this.lines[end - 1] === "") end--;
    return [k + 1, end];
  }

  /** What a key's line says after its =, or null. */
  get(heading, key, number = 0) {
    const line = this.find(heading, key, number);
    return line === null ? null : this.lines[line].slice(key.length + 3);
  }

  find(heading, key, number) {
    const range = this.range(heading, number);
    if (range === null) return null;
    for (let k = range[0]; k < range[1]; k++) {
      if (this.lines[k].startsWith(`${key} = `)) return k;
    }
    return null;
  }

  /** Give a key a value; the section is added where it is not there. */
  put(heading, key, value, number = 0) {
    const line = this.find(heading, key, number);
    if (line !== null) {
      this.lines[line] = `${key} = ${value}`;
      return;
    }
    const range = this.range(heading, number);
    if (range === null) this.lines.push("", heading, `${key} = ${value}`);
    else this.lines.splice(range[1], 0, `${key} = ${value}`);
  }

  drop(heading, key) {
    const line = this.find(heading, key, 0);
    if (line !== null) this.lines.splice(line, 1);
  }

  dropSection(heading) {
    const range = this.range(heading);
    if (range !== null) this.lines.splice(range[0] - 1, range[1] - range[0] + 1);
  }

  /** How many sections have a heading. */
  count(heading) {
    return this.lines.filter((line) => line === heading).length;
  }
}
