/** A zip archive of text files, stored as they are. */

const TABLE = Array.from({ length: 256 }, (_, n) => {
  let c = n;
  for (let k = 0; k < 8; k++) c = c & 1 ? (c >>> 1) ^ 0xedb88320 : c >>> 1;
  return c >>> 0;
});

function checksum(bytes) {
  let c = 0xffffffff;
  for (const byte of bytes) c = TABLE[(c ^ byte) & 255] ^ (c >>> 8);
  return (c ^ 0xffffffff) >>> 0;
}

/** The bytes of an archive of files, { name: text }. */
export function zipped(files) {
  const parts = [];
  const entries = [];
  let at = 0;
  for (const [name, text] of Object.entries(files)) {
    const [title, content] = [name, text].map((each) => new TextEncoder().encode(each));
    const about = [20, 0x800, 0, 0, 0x21]; // version, UTF-8, stored, 1 January 1980
    const sizes = [checksum(content), content.length, content.length];
    const [local, central] = [[title.length, 0], [20, ...about]];
    const head = bytesOf([[4, 0x04034b50], ...shorts(about), ...longs(sizes), ...shorts(local)]);
    const rest = shorts([title.length, 0, 0, 0, 0]);
    const fields = [...shorts(central), ...longs(sizes), ...rest];
    entries.push(bytesOf([[4, 0x02014b50], ...fields, [4, 0], [4, at]]), title);
    parts.push(head, title, content);
    at += head.length + title.length + content.length;
  }
  const size = entries.reduce((sum, each) => sum + each.length, 0);
  const count = entries.length / 2;
  const end = [[4, 0x06054b50], ...shorts([0, 0, count, count]), ...longs([size, at]), [2, 0]];
  return new Blob([...parts, ...entries, bytesOf(end)], { type: "application/zip" });
}

function shorts(values) {
  return values.map((value) => [2, value]);
}

function longs(values) {
  return values.map((value) => [4, value]);
}

/** Little-endian bytes of [width, value] each. */
function bytesOf(fields) {
  return Uint8Array.from(fields.flatMap(([width, value]) =>
    Array.from({ length: width }, (_, k) => (value >>> (8 * k)) & 255)));
}
