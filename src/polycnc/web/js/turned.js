// A body that is turned: an outer and an inner radius for each cell along its axis, which lies along x of the picture.
import { BufferAttribute, BufferGeometry, DataTexture, DoubleSide, FloatType, NearestFilter, RGFormat, ShaderMaterial, Vector2 } from "three";
import { Body, LOOK } from "./body.js";

const FACETS = 96;
const VERTEX = `
precision highp sampler2D;
uniform sampler2D field;
uniform vec2 row;
attribute vec3 ring; // place along the axis, 0 outside or 1 inside, angle
varying vec3 place;
varying float along, wall;
void main() {
  int cell = int(clamp(ring.x, 0.0, row.x - 1.0) + 0.5);
  float outer = texelFetch(field, ivec2(cell, 0), 0).r, inner = texelFetch(field, ivec2(cell, 1), 0).r;
  float radius = ring.y < 0.5 ? outer : inner;
  wall = outer - inner;
  along = clamp(ring.x, 0.0, row.x - 1.0);
  vec4 at = modelMatrix * vec4(row.y * clamp(ring.x, -0.5, row.x - 0.5), radius * sin(ring.z), radius * cos(ring.z), 1.0);
  place = at.xyz;
  gl_Position = projectionMatrix * viewMatrix * at;
}`;
const FRAGMENT = `
precision highp sampler2D;
uniform sampler2D field;
uniform vec2 middle;
uniform vec2 row;
varying vec3 place;
varying float along, wall;
${LOOK}
vec2 cellOf(float at, int side) { return texelFetch(field, ivec2(int(clamp(at, 0.0, row.x - 1.0)), side), 0).rg; }
void main() {
  if (dot(section.xyz, place) > section.w || wall < 1e-3) discard;
  vec3 flat_normal = normalize(cross(dFdx(place), dFdy(place))), toward = towardViewer();
  vec2 out_of = normalize(place.yz - middle + vec2(1e-9, 0.0));
  float sideways = dot(flat_normal.yz, out_of) < 0.0 ? -1.0 : 1.0;
  vec3 normal = vec3(flat_normal.x, sideways * sqrt(max(0.0, 1.0 - flat_normal.x * flat_normal.x)) * out_of);
  if (dot(normal, toward) < 0.0) normal = -normal;
  // The later cut of the two cells beside it, on the side that is nearer to the radius here.
  float radius = length(place.yz - middle), stamp = 0.0, nearest = 1e9;
  for (int side = 0; side < 2; side++) {
    vec2 a = cellOf(floor(along), side), b = cellOf(ceil(along), side);
    float off = min(abs(a.x - radius), abs(b.x - radius));
    if (off < nearest) { nearest = off; stamp = max(a.y, b.y); }
  }
  gl_FragColor = isCut() && !gl_FrontFacing ? INSIDE : shaded(colourOf(stamp), normal, toward);
}`;

export class Turned extends Body {
  // `place` of the picture is where the axis has the middle of the first cell.
  constructor({ size, cell, place, ...film }) {
    super(film);
    [this.count] = size;
    Object.assign(this, { cell, place });
    this.texture = new DataTexture(this.shown, this.count, 2, RGFormat, FloatType);
    this.texture.minFilter = this.texture.magFilter = NearestFilter;
    this.texture.needsUpdate = true;
    Object.assign(this.uniforms, { field: { value: this.texture }, row: { value: new Vector2(this.count, cell) }, middle: { value: new Vector2(place[1], place[2]) } });
    this.mesh = Body.surfaceOf(Turned.geometry(this.count), new ShaderMaterial({ vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms: this.uniforms, side: DoubleSide, polygonOffset: true, polygonOffsetFactor: 1.5, polygonOffsetUnits: 4 }));
    this.mesh.position.set(...place);
    let most = 0;
    for (let n = 0; n < this.count; n++) most = Math.max(most, this.radii(n)[0]);
    this.box = [[place[0] - cell / 2, place[0] + (this.count - 0.5) * cell], ...[1, 2].map((i) => [place[i] - most, place[i] + most])];
  }

  // Rings out along the outer radii, back along the inner ones, and closed.
  static geometry(count) {
    const places = [-0.5, ...Array(count).keys(), count - 0.5], rings = [...places.map((at) => [at, 0]), ...places.toReversed().map((at) => [at, 1])];
    const wide = FACETS + 1, ring = new Float32Array(3 * wide * rings.length), index = [];
    rings.forEach(([at, side], k) => { for (let f = 0; f < wide; f++) ring.set([at, side, 2 * Math.PI * (f % FACETS) / FACETS], 3 * (k * wide + f)); });
    for (let k = 0; k < rings.length; k++) for (let f = 0; f < FACETS; f++) {
      const a = k * wide + f, b = a + 1, d = (k + 1) % rings.length * wide + f, c = d + 1;
      index.push(a, c, b, a, d, c);
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(ring, 3));
    geometry.setAttribute("ring", new BufferAttribute(ring, 3));
    geometry.setIndex(index);
    return geometry;
  }

  refresh() { this.texture.needsUpdate = true; }

  radii(n) { return [0, 1].map((side) => this.shown[2 * (side * this.count + n)]); }

  // The step that made the surface at a place, null where there is nothing.
  stampAt([x, y, z]) {
    const n = Math.min(Math.max(Math.round((x - this.place[0]) / this.cell), 0), this.count - 1), radius = Math.hypot(y - this.place[1], z - this.place[2]);
    const [outer, inner] = this.radii(n);
    if (outer - inner < 1e-3 || radius > outer || radius < inner) return null;
    return this.shown[2 * ((outer - radius < radius - inner ? 0 : this.count) + n) + 1];
  }

  // The closed surface, with X, Y and Z as programs have them; the profile is kept where it is not level.
  surface() {
    const { count, cell, place } = this, profile = [];
    const same = (n, m) => m >= 0 && m < count && this.radii(n).every((r, side) => r === this.radii(m)[side]);
    for (let n = 0; n < count; n++) if (!same(n, n - 1) || !same(n, n + 1)) profile.push([n, ...this.radii(n)]);
    const ends = [[-0.5, ...this.radii(0)], ...profile, [count - 0.5, ...this.radii(count - 1)]];
    const rings = [...ends.map(([n, outer]) => [n, outer]), ...ends.toReversed().map(([n, , inner]) => [n, inner])];
    const vertices = [], faces = [], known = new Map(), facets = Array.from({ length: FACETS }, (_, f) => 2 * Math.PI * f / FACETS);
    const wider = Math.sqrt(2 * Math.PI / FACETS / Math.sin(2 * Math.PI / FACETS)); // the volume of the round body
    const vertex = (n, r, f) => { // corners at the same place are one
      const key = `${n} ${r} ${r > 0 ? f : 0}`;
      if (!known.has(key)) {
        known.set(key, vertices.length / 3);
        vertices.push(place[2] + wider * r * Math.cos(facets[f]), place[1] + wider * r * Math.sin(facets[f]), place[0] + n * cell);
      }
      return known.get(key);
    };
    rings.forEach(([n, r], k) => {
      const [m, s] = rings[(k + 1) % rings.length];
      for (let f = 0; f < FACETS; f++) {
        const g = (f + 1) % FACETS, [a, b, c, d] = [vertex(n, r, f), vertex(n, r, g), vertex(m, s, g), vertex(m, s, f)];
        for (const corners of [[a, b, c], [a, c, d]]) if (new Set(corners).size === 3) faces.push(...corners);
      }
    });
    return { vertices, faces };
  }
}

