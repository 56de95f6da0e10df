// A body that is cut: a height for each cell, and every change with its time. Going back undoes the changes.
import { BufferAttribute, BufferGeometry, DataTexture, DoubleSide, FloatType, Group, Mesh, NearestFilter, RGBAFormat, RGFormat, ShaderMaterial, Vector2, Vector4 } from "three";
import { after } from "./format.js";

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
uniform sampler2D colours;
uniform vec4 section;
uniform float base;
uniform vec2 lit, size;
uniform sampler2D field;
varying vec3 place;
varying float high;
varying vec2 cell_at;
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
    for (int j = -1; j <= 2; j++) for (int i = -1; i <= 2; i++) {
      vec2 off = vec2(float(i), float(j));
      fall += (off - 0.5) * cellOf(corner + off).x;
    }
    if (length(fall) > 1e-6) normal = normalize(vec3(-normalize(fall) * length(normal.xy), abs(normal.z)));
    for (int n = 0; n < 4; n++) stamp = max(stamp, cellOf(corner + vec2(float(n & 1), float(n >> 1))).y);
  }
  vec3 toward = normalize(vec3(viewMatrix[0].z, viewMatrix[1].z, viewMatrix[2].z));
  if ((!wall || base > 0.5 || !within) && dot(normal, toward) < 0.0) normal = -normal;
  bool inside = (base > 0.5) ? gl_FrontFacing : !gl_FrontFacing;
  vec3 colour = vec3(0.70, 0.74, 0.78);
  if (stamp > 0.5) colour = mix(vec3(0.93, 0.93, 0.91), texelFetch(colours, ivec2(int(stamp + 0.5) - 1, 0), 0).rgb, 0.5);
  if (stamp > lit.x && stamp <= lit.y) colour = mix(colour, vec3(1.0, 0.72, 0.2), 0.55);
  vec3 lamp = normalize(vec3(-0.45, -0.6, 1.0));
  float light = 0.46 + 0.44 * max(dot(normal, lamp), 0.0) + 0.16 * max(dot(normal, toward), 0.0);
  light += 0.22 * pow(max(dot(reflect(-lamp, normal), toward), 0.0), 18.0);
  if (inside) gl_FragColor = vec4(0.80, 0.42, 0.22, 1.0);
  else gl_FragColor = vec4(colour * light, 1.0);
}`;

export class Field {
  // `begin` levels of cells, changes of steps that end at `ends`: `counts` cells each, `jumps` from one to the next, `levels`
  constructor({ size, cell, level, place, begin, ends, counts, jumps, levels }) {
    const [nx, ny] = size;
    Object.assign(this, { size, ends, levels, level, step: 0, changes: jumps.length });
    this.cells = new Int32Array(jumps.length);
    for (let n = 0, at = 0; n < jumps.length; n++) this.cells[n] = at += jumps[n];
    this.first = new Int32Array(counts.length + 1);
    for (let s = 0; s < counts.length; s++) this.first[s + 1] = this.first[s] + counts[s];
    this.old = new Uint16Array(jumps.length); // what was there before each change
    this.oldStamp = new Uint16Array(jumps.length);
    const heights = Uint16Array.from(begin), stamps = new Uint16Array(begin.length);
    for (let s = 0; s < counts.length; s++) for (let n = this.first[s]; n < this.first[s + 1]; n++) {
      const at = this.cells[n];
      this.old[n] = heights[at]; this.oldStamp[n] = stamps[at];
      heights[at] = levels[n]; stamps[at] = s + 1;
    }
    this.shown = new Float32Array(2 * nx * ny);
    begin.forEach((value, at) => { this.shown[2 * at] = value * level; });
    this.texture = new DataTexture(this.shown, nx, ny, RGFormat, FloatType);
    this.texture.minFilter = this.texture.magFilter = NearestFilter;
    this.texture.needsUpdate = true;
    this.colours = new Uint8Array(4 * Math.max(ends.length, 1)).fill(255);
    this.colourTexture = new DataTexture(this.colours, Math.max(ends.length, 1), 1, RGBAFormat);
    this.colourTexture.needsUpdate = true;
    const uniforms = { field: { value: this.texture }, colours: { value: this.colourTexture }, size: { value: new Vector2(nx, ny) }, section: { value: new Vector4(0, 0, 0, 1) }, lit: { value: new Vector2(-1, -1) } };
    const geometry = Field.geometry(nx, ny), material = (base) => new ShaderMaterial({ vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms: { ...uniforms, base: { value: base } }, side: DoubleSide, polygonOffset: true, polygonOffsetFactor: 1.5, polygonOffsetUnits: 4 });
    this.uniforms = uniforms;
    this.mesh = new Group();
    for (const base of [0, 1]) { const mesh = new Mesh(geometry, material(base)); mesh.frustumCulled = false; this.mesh.add(mesh); }
    this.mesh.position.set(...place);
    this.mesh.scale.set(cell, cell, 1);
    const top = begin.reduce((high, value) => Math.max(high, value), 0) * level;
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

  // Show the body as it is at a time.
  goTo(t) {
    const wanted = after(this.ends, t + 1e-9);
    if (wanted === this.step) return;
    for (; this.step < wanted; this.step++) for (let n = this.first[this.step]; n < this.first[this.step + 1]; n++) {
      this.shown[2 * this.cells[n]] = this.levels[n] * this.level;
      this.shown[2 * this.cells[n] + 1] = this.step + 1;
    }
    for (; this.step > wanted; this.step--) for (let n = this.first[this.step] - 1; n >= this.first[this.step - 1]; n--) {
      this.shown[2 * this.cells[n]] = this.old[n] * this.level;
      this.shown[2 * this.cells[n] + 1] = this.oldStamp[n];
    }
    this.texture.needsUpdate = true;
  }

  // The heights that are shown above the bottom, with what they mean.
  solid() {
    return { heights: this.shown.filter((_, n) => n % 2 === 0), size: this.size, cell: this.mesh.scale.x, place: this.mesh.position.toArray() };
  }

  // Colour what was cut; `of(t)` returns r, g, b (0 to 255) of a time.
  paint(of) {
    this.ends.forEach((t, s) => this.colours.set(of(t), 4 * s));
    this.colourTexture.needsUpdate = true;
  }

  // The place of the surface on a line of sight from `from` to `to` (in the body's own frame), and the time of the cut
  // that made it: {place, t}, t null where nothing was cut; null where the line misses what is shown.
  pick(from, to) {
    const { x: cell } = this.mesh.scale, { x, y, z } = this.mesh.position, [nx, ny] = this.size, { section } = this.uniforms;
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
      const { value: out } = section;
      if (out.x * place[0] + out.y * place[1] + out.z * place[2] > out.w) continue;
      if (n === steps || way[2] < 0) place[2] = Math.min(place[2], z + this.shown[k]);
      const stamp = this.shown[k + 1];
      return { place, t: stamp ? this.ends[stamp - 1] : null };
    }
    return null;
  }

  light(from, to) { this.uniforms.lit.value.set(after(this.ends, from + 1e-6), after(this.ends, to + 1e-6)); }

  // The bottom is seen from below only.
  seenFrom(camera, target) { this.mesh.children[1].visible = camera.z < target.z; }

  // Leave out what is beyond a plane across an axis; null for all.
  cutAt(axis, at) { this.uniforms.section.value.set(axis === 0 ? 1 : 0, axis === 1 ? -1 : 0, 0, axis === null ? 1 : axis === 1 ? -at : at); }
}
