// A body seen from above: a height for each cell of a grid.
import { BufferAttribute, BufferGeometry, DataTexture, DoubleSide, FloatType, Group, NearestFilter, RGFormat, ShaderMaterial, Vector2 } from "three";
import { Body, LOOK } from "./body.js";

const VERTEX = `
precision highp sampler2D;
uniform sampler2D field;
uniform vec2 size;
uniform float base;
attribute vec3 grid;
varying vec3 place;
varying float high;
varying vec2 cell_at;
void main() {
  cell_at = grid.xy;
  vec2 cell = clamp(grid.xy, vec2(0.0), size - 1.0);
  vec2 found = texelFetch(field, ivec2(cell), 0).rg;
  high = found.x;
  float z = mix(found.x, 0.0, max(grid.z, base));
  vec4 at = modelMatrix * vec4(clamp(grid.xy, vec2(-0.5), size - 0.5), z, 1.0);
  place = at.xyz;
  gl_Position = projectionMatrix * viewMatrix * at;
}`;
const FRAGMENT = `
precision highp sampler2D;
uniform float base;
uniform vec2 size;
uniform sampler2D field;
varying vec3 place;
varying float high;
varying vec2 cell_at;
${LOOK}
vec2 cellOf(vec2 at) { return texelFetch(field, ivec2(clamp(at, vec2(0.0), size - 1.0)), 0).rg; }
void main() {
  if (dot(section.xyz, place) > section.w) discard;
  if (high < 1e-3) discard;
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  bool wall = abs(normal.z) < 0.9;
  float stamp = cellOf(floor(cell_at + 0.5)).y;
  bool within = all(greaterThan(cell_at, vec2(-0.49))) && all(lessThan(cell_at, size - 0.51));
  if (wall && base < 0.5 && within) { // a wall looks where its neighbourhood falls to, and has the colour of the later cut
    vec2 fall = vec2(0.0), corner = floor(cell_at);
    for (int j = -2; j <= 3; j++) for (int i = -2; i <= 3; i++) {
      vec2 off = vec2(float(i), float(j));
      fall += (off - 0.5) * cellOf(corner + off).x;
    }
    if (length(fall) > 1e-6) normal = normalize(vec3(-normalize(fall) * length(normal.xy), abs(normal.z)));
    for (int n = 0; n < 4; n++) stamp = max(stamp, cellOf(corner + vec2(float(n & 1), float(n >> 1))).y);
  }
  vec3 toward = towardViewer();
  if ((!wall || base > 0.5 || !within) && dot(normal, toward) < 0.0) normal = -normal;
  bool inside = isCut() && ((base > 0.5) ? gl_FrontFacing : !gl_FrontFacing);
  gl_FragColor = inside ? INSIDE : shaded(colourOf(stamp), normal, toward);
}`;

export class Field extends Body {
  // `place` is the middle of the first cell, on the bottom.
  constructor({ size, cell, place, ...film }) {
    super(film);
    const [nx, ny] = size;
    Object.assign(this, { size, cell });
    this.texture = new DataTexture(this.shown, nx, ny, RGFormat, FloatType);
    this.texture.minFilter = this.texture.magFilter = NearestFilter;
    this.texture.needsUpdate = true;
    Object.assign(this.uniforms, { field: { value: this.texture }, size: { value: new Vector2(nx, ny) } });
    const geometry = Field.geometry(nx, ny), material = (base) => new ShaderMaterial({ vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms: { ...this.uniforms, base: { value: base } }, side: DoubleSide, polygonOffset: base === 0, polygonOffsetFactor: 1.5, polygonOffsetUnits: 4 });
    this.mesh = new Group();
    for (const base of [0, 1]) this.mesh.add(Body.surfaceOf(geometry, material(base)));
    this.mesh.position.set(...place);
    this.mesh.scale.set(cell, cell, 1);
    const top = film.begin.reduce((high, value) => Math.max(high, value), 0) * film.level;
    this.box = [0, 1].map((i) => [place[i] - cell / 2, place[i] + (size[i] - 0.5) * cell]).concat([[place[2], place[2] + top]]);
  }

  static geometry(nx, ny) { // a vertex for each cell, one more at every edge, and one below that
    const wide = nx + 4, grid = new Float32Array(3 * wide * (ny + 4)), index = [];
    const along = (i, n) => (i < 2 ? -0.5 : i > n + 1 ? n - 0.5 : i - 2);
    for (let j = 0; j < ny + 4; j++) for (let i = 0; i < wide; i++) {
      grid.set([along(i, nx), along(j, ny), i === 0 || j === 0 || i === wide - 1 || j === ny + 3 ? 1 : 0], 3 * (j * wide + i));
      if (i && j) { const d = j * wide + i, c = d - 1, b = d - wide, a = b - 1; index.push(a, b, d, a, d, c); }
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("grid", new BufferAttribute(grid, 3));
    geometry.setIndex(index);
    return geometry;
  }

  refresh() { this.texture.needsUpdate = true; }

  // The closed surface that is shown: heights at the middles of the cells, walls a cell wide, upright sides.
  surface() {
    const { size: [nx, ny], cell, shown } = this, place = this.mesh.position.toArray();
    const wide = nx + 4, high = ny + 4, count = wide * high, along = (i, n) => (i < 2 ? -0.5 : i > n + 1 ? n - 0.5 : i - 2);
    const inner = (i, n) => Math.min(Math.max(i - 2, 0), n - 1), z = new Float64Array(count), number = new Int32Array(2 * count).fill(-1);
    for (let j = 1; j < high - 1; j++) for (let i = 1; i < wide - 1; i++) z[j * wide + i] = Math.max(shown[2 * (inner(j, ny) * nx + inner(i, nx))], 0);
    const vertices = [], faces = [];
    const vertex = (at, below) => { // where the top lies on the bottom both share a corner
      const key = below && z[at] > 0 ? at + count : at;
      if (number[key] < 0) {
        number[key] = vertices.length / 3;
        vertices.push(place[0] + cell * along(at % wide, nx), place[1] + cell * along(Math.floor(at / wide), ny), place[2] + (below ? 0 : z[at]));
      }
      return number[key];
    };
    for (let j = 1; j < high; j++) for (let i = 1; i < wide; i++) {
      const c = j * wide + i, d = c - 1, b = c - wide, a = b - 1;
      for (const corners of [[a, b, c], [a, c, d]]) {
        if (corners.every((at) => z[at] <= 0)) continue;
        faces.push(...corners.map((at) => vertex(at, false)), ...corners.reverse().map((at) => vertex(at, true)));
      }
    }
    return { vertices, faces };
  }

  // The same as for any body, but as high as the cell that is met from above.
  pick(from, to) {
    const { cell } = this, { x, y, z } = this.mesh.position, [nx, ny] = this.size;
    const at = [x, y, z].map((zero, i) => (from[i] - zero) / (i < 2 ? cell : 1)), way = at.map((v, i) => (to[i] - [x, y, z][i]) / (i < 2 ? cell : 1) - v);
    const span = [[-0.5, nx - 0.5], [-0.5, ny - 0.5], [0, this.box[2][1] - z]];
    let [first, last] = [0, 1];
    for (let i = 0; i < 3; i++) {
      const [a, b] = span[i].map((bound) => (bound - at[i]) / (way[i] || 1e-12)).sort((p, q) => p - q);
      first = Math.max(first, a); last = Math.min(last, b);
    }
    if (first > last) return null;
    const steps = Math.ceil((last - first) * Math.max(2 * Math.hypot(way[0], way[1]), 1)) + 1, mm = [x, y, z];
    for (let n = 0; n <= steps; n++) {
      const share = first + (last - first) * n / steps, p = at.map((v, i) => v + share * way[i]);
      const i = Math.min(Math.max(Math.round(p[0]), 0), nx - 1), j = Math.min(Math.max(Math.round(p[1]), 0), ny - 1), k = 2 * (j * nx + i);
      if (this.shown[k] < 1e-3 || p[2] > this.shown[k] + 1e-6) continue;
      const place = p.map((v, axis) => mm[axis] + v * (axis < 2 ? cell : 1));
      if (this.isLeftOut(place)) continue;
      if (n === steps || way[2] < 0) place[2] = Math.min(place[2], z + this.shown[k]);
      return { place, t: this.timeOf(this.shown[k + 1]) };
    }
    return null;
  }

  // The bottom is seen from below, and through a section from within.
  seenFrom(camera, target) { this.mesh.children[1].visible = camera.z < target.z || this.isSection; }
}
