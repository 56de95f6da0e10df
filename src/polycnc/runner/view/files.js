// What a page saves: its body as STL or 3MF (core specification, mm), its picture as PNG.

export function stl({ vertices, faces }) {
  const count = faces.length / 3, data = new DataView(new ArrayBuffer(84 + 50 * count));
  [..."polycnc"].forEach((letter, i) => data.setUint8(i, letter.charCodeAt(0)));
  data.setUint32(80, count, true);
  for (let f = 0; f < count; f++) {
    const [a, b, c] = [0, 1, 2].map((k) => [0, 1, 2].map((i) => vertices[3 * faces[3 * f + k] + i]));
    const u = b.map((v, i) => v - a[i]), v = c.map((w, i) => w - a[i]);
    const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]], long = Math.hypot(...normal) || 1;
    [...normal.map((n) => n / long), ...a, ...b, ...c].forEach((value, i) => data.setFloat32(84 + 50 * f + 4 * i, value, true));
  }
  return new Blob([data], { type: "model/stl" });
}

const XML = '<?xml version="1.0" encoding="UTF-8"?>\n';
const TYPES = `${XML}<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>`;
const RELATIONS = `${XML}<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>`;

export async function threeMf({ vertices, faces }) {
  const number = (value) => Number(value.toFixed(4)), parts = [`${XML}<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources><object id="1" type="model"><mesh><vertices>`];
  for (let i = 0; i < vertices.length; i += 3) parts.push(`<vertex x="${number(vertices[i])}" y="${number(vertices[i + 1])}" z="${number(vertices[i + 2])}"/>`);
  parts.push("</vertices><triangles>");
  for (let i = 0; i < faces.length; i += 3) parts.push(`<triangle v1="${faces[i]}" v2="${faces[i + 1]}" v3="${faces[i + 2]}"/>`);
  parts.push('</triangles></mesh></object></resources><build><item objectid="1"/></build></model>');
  return zipped([["[Content_Types].xml", TYPES], ["_rels/.rels", RELATIONS], ["3D/3dmodel.model", parts.join("")]]);
}

const CRC = new Uint32Array(256).map((_, n) => { let c = n; for (let k = 0; k < 8; k++) c = c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1; return c; });

async function zipped(files) { // deflated, the date that of the first day that the format knows
  const pieces = [], entries = [];
  let at = 0;
  for (const [name, text] of files) {
    const raw = new TextEncoder().encode(text), title = new TextEncoder().encode(name);
    const packed = new Uint8Array(await new Response(new Blob([raw]).stream().pipeThrough(new CompressionStream("deflate-raw"))).arrayBuffer());
    const crc = (raw.reduce((c, byte) => CRC[(c ^ byte) & 255] ^ (c >>> 8), 0xffffffff) ^ 0xffffffff) >>> 0;
    const common = [[2, 20], [2, 0], [2, 8], [2, 0], [2, 0x21], [4, crc], [4, packed.length], [4, raw.length], [2, title.length], [2, 0]];
    const header = fields([[4, 0x04034b50], ...common]);
    entries.push(fields([[4, 0x02014b50], [2, 20], ...common, [2, 0], [2, 0], [2, 0], [4, 0], [4, at]]), title);
    pieces.push(header, title, packed);
    at += header.length + title.length + packed.length;
  }
  const size = entries.reduce((sum, each) => sum + each.length, 0);
  return new Blob([...pieces, ...entries, fields([[4, 0x06054b50], [2, 0], [2, 0], [2, files.length], [2, files.length], [4, size], [4, at], [2, 0]])], { type: "model/3mf" });
}

function fields(values) {
  const data = new DataView(new ArrayBuffer(values.reduce((sum, [size]) => sum + size, 0)));
  let at = 0;
  for (const [size, value] of values) { if (size === 2) data.setUint16(at, value, true); else data.setUint32(at, value, true); at += size; }
  return new Uint8Array(data.buffer);
}

export function save(blob, name) {
  const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob), download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}
