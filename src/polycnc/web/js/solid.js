// A body that is cut from all sides: the share of each cell that is full; its surface is found anew when it changes.
import { BufferAttribute, BufferGeometry, DoubleSide, ShaderMaterial } from "three";
import { Body, LOOK } from "./body.js";

const VERTEX = `
attribute float stamp;
varying vec3 place, facing, colour;
${LOOK}
void main() {
  vec4 at = modelMatrix * vec4(position, 1.0);
  place = at.xyz;
  facing = mat3(modelMatrix) * normal;
  colour = colourOf(stamp);
  gl_Position = projectionMatrix * viewMatrix * at;
}`;
const FRAGMENT = `
varying vec3 place, facing, colour;
${LOOK}
void main() {
  if (dot(section.xyz, place) > section.w) discard;
  vec3 toward = towardViewer(), around = normalize(facing);
  if (dot(around, toward) < 0.0) around = -around;
  gl_FragColor = isCut() && !gl_FrontFacing ? INSIDE : shaded(colour, around, toward);
}`;
const HALF = 0.5; // a cell that is so full is at the surface

export class Solid extends Body {
  // `place` is the middle of the first cell.
  constructor({ size, cell, place, ...film }) {
    super(film);
    Object.assign(this, { size, cell, place });
    this.geometry = new BufferGeometry();
    this.mesh = Body.surfaceOf(this.geometry, new ShaderMaterial({ vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms: this.uniforms, side: DoubleSide, polygonOffset: true, polygonOffsetFactor: 1.5, polygonOffsetUnits: 4 }));
    this.box = size.map((count, i) => [place[i] - cell / 2, place[i] + (count - 0.5) * cell]);
    this.refresh();
  }

  refresh() {
    const { vertices, faces, stamps } = this.surface(), normals = new Float32Array(vertices.length);
    for (let f = 0; f < faces.length; f += 3) { // of a corner: the mean of the triangles around it, by their area
      const [a, b, c] = [3 * faces[f], 3 * faces[f + 1], 3 * faces[f + 2]];
      const ux = vertices[b] - vertices[a], uy = vertices[b + 1] - vertices[a + 1], uz = vertices[b + 2] - vertices[a + 2];
      const vx = vertices[c] - vertices[a], vy = vertices[c + 1] - vertices[a + 1], vz = vertices[c + 2] - vertices[a + 2];
      const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
      for (const at of [a, b, c]) { normals[at] += nx; normals[at + 1] += ny; normals[at + 2] += nz; }
    }
    this.geometry.setAttribute("position", new BufferAttribute(Float32Array.from(vertices), 3));
    this.geometry.setAttribute("normal", new BufferAttribute(normals, 3));
    this.geometry.setAttribute("stamp", new BufferAttribute(Float32Array.from(stamps), 1));
    this.geometry.setIndex(new BufferAttribute(Uint32Array.from(faces), 1));
  }

  // The closed surface: a corner in each cube between eight cells where it goes through, at the mean of its crossings.
  surface() {
    const { size: [nx, ny, nz], cell, place, shown } = this, vertices = [], faces = [], stamps = [];
    const wide = nx + 1, high = ny + 1, number = new Int32Array(wide * high * (nz + 1)).fill(-1);
    const value = (i, j, k) => (i < 0 || j < 0 || k < 0 || i >= nx || j >= ny || k >= nz ? 0 : shown[2 * ((k * ny + j) * nx + i)]);
    const stamp = (i, j, k) => (i < 0 || j < 0 || k < 0 || i >= nx || j >= ny || k >= nz ? 0 : shown[2 * ((k * ny + j) * nx + i) + 1]);
    const corner = new Float64Array(8);
    for (let k = 0; k <= nz; k++) for (let j = 0; j <= ny; j++) for (let i = 0; i <= nx; i++) { // the cube up to cell i, j, k
      let full = 0;
      for (let n = 0; n < 8; n++) { corner[n] = value(i - 1 + (n & 1), j - 1 + (n >> 1 & 1), k - 1 + (n >> 2)); if (corner[n] >= HALF) full |= 1 << n; }
      if (full === 0 || full === 255) continue;
      let count = 0, x = 0, y = 0, z = 0, newest = 0;
      for (let n = 0; n < 8; n++) {
        newest = Math.max(newest, stamp(i - 1 + (n & 1), j - 1 + (n >> 1 & 1), k - 1 + (n >> 2)));
        for (let axis = 1; axis < 8; axis <<= 1) {
          const m = n | axis;
          if (n & axis || (full >> n & 1) === (full >> m & 1)) continue;
          const share = (corner[n] - HALF) / (corner[n] - corner[m]);
          x += (n & 1) + (axis === 1 ? share : 0); y += (n >> 1 & 1) + (axis === 2 ? share : 0); z += (n >> 2) + (axis === 4 ? share : 0);
          count++;
        }
      }
      number[(k * high + j) * wide + i] = stamps.length;
      vertices.push(place[0] + cell * (i - 1 + x / count), place[1] + cell * (j - 1 + y / count), place[2] + cell * (k - 1 + z / count));
      stamps.push(newest);
    }
    const step = [1, wide, wide * high];
    for (let k = 0; k <= nz; k++) for (let j = 0; j <= ny; j++) for (let i = 0; i <= nx; i++) { // the sides between a cell and those after it
      const at = (k * high + j) * wide + i, here = value(i - 1, j - 1, k - 1) >= HALF;
      for (let axis = 0; axis < 3; axis++) {
        const there = value(i - 1 + (axis === 0), j - 1 + (axis === 1), k - 1 + (axis === 2)) >= HALF;
        if (here === there) continue;
        const u = step[(axis + 1) % 3], v = step[(axis + 2) % 3];
        // The four cubes around the edge from the cell before this corner to the next one along the axis.
        const a = number[at], b = number[at - u], c = number[at - u - v], d = number[at - v];
        if (here) faces.push(a, b, c, a, c, d); else faces.push(a, c, b, a, d, c);
      }
    }
    return { vertices, faces, stamps };
  }

  // The step that made the surface at a place, null where there is nothing.
  stampAt(at) {
    const [i, j, k] = at.map((v, n) => Math.min(Math.max(Math.round((v - this.place[n]) / this.cell), 0), this.size[n] - 1));
    const n = 2 * ((k * this.size[1] + j) * this.size[0] + i);
    if (this.shown[n] < HALF) return null;
    let newest = this.shown[n + 1];
    for (const [a, b, c] of [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]) {
      const [x, y, z] = [i + a, j + b, k + c];
      if (x >= 0 && y >= 0 && z >= 0 && x < this.size[0] && y < this.size[1] && z < this.size[2]) newest = Math.max(newest, this.shown[2 * ((z * this.size[1] + y) * this.size[0] + x) + 1]);
    }
    return newest;
  }
}
