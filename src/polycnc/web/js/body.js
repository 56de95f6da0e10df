// A body that is cut: a level for each of its cells, and every change with its time. Going back undoes the changes.
import { DataTexture, Mesh, RGBAFormat, Vector2, Vector4 } from "three";
import { after } from "./format.js";

// What the shaders of all bodies share: where the section is, and how a surface looks in the light.
export const LOOK = `
uniform sampler2D colours;
uniform vec4 section;
uniform vec2 lit;
vec3 colourOf(float stamp) {
  vec3 colour = vec3(0.70, 0.74, 0.78);
  if (stamp > 0.5) colour = mix(vec3(0.93, 0.93, 0.91), texelFetch(colours, ivec2(int(stamp + 0.5) - 1, 0), 0).rgb, 0.5);
  return stamp > lit.x && stamp <= lit.y ? mix(colour, vec3(1.0, 0.72, 0.2), 0.55) : colour;
}
vec4 shaded(vec3 colour, vec3 normal, vec3 toward) {
  vec3 lamp = normalize(vec3(-0.45, -0.6, 1.0));
  float light = 0.46 + 0.44 * max(dot(normal, lamp), 0.0) + 0.16 * max(dot(normal, toward), 0.0);
  light += 0.22 * pow(max(dot(reflect(-lamp, normal), toward), 0.0), 18.0);
  return vec4(colour * light, 1.0);
}
vec3 towardViewer() { return normalize(vec3(viewMatrix[0].z, viewMatrix[1].z, viewMatrix[2].z)); }
bool isCut() { return dot(section.xyz, section.xyz) > 0.0; } // else what is seen from within is but an edge
const vec4 INSIDE = vec4(0.80, 0.42, 0.22, 1.0);
`;

export class Body {
  // `begin` levels of cells, changes of steps that end at `ends`: `counts` cells each, `jumps` from one to the next, `levels`
  constructor({ level, begin, ends, counts, jumps, levels }) {
    Object.assign(this, { ends, levels, level, step: 0, changes: jumps.length });
    this.cells = new Int32Array(jumps.length);
    for (let n = 0, at = 0; n < jumps.length; n++) this.cells[n] = at += jumps[n];
    this.first = new Int32Array(counts.length + 1);
    for (let s = 0; s < counts.length; s++) this.first[s + 1] = this.first[s] + counts[s];
    this.old = new Uint16Array(jumps.length); // what was there before each change
    this.oldStamp = new Uint16Array(jumps.length);
    const now = Uint16Array.from(begin), stamps = new Uint16Array(begin.length);
    for (let s = 0; s < counts.length; s++) for (let n = this.first[s]; n < this.first[s + 1]; n++) {
      const at = this.cells[n];
      this.old[n] = now[at]; this.oldStamp[n] = stamps[at];
      now[at] = levels[n]; stamps[at] = s + 1;
    }
    this.shown = new Float32Array(2 * begin.length); // of each cell what it is, and the step that made it so
    begin.forEach((value, at) => { this.shown[2 * at] = value * level; });
    this.colours = new Uint8Array(4 * Math.max(ends.length, 1)).fill(255);
    this.colourTexture = new DataTexture(this.colours, Math.max(ends.length, 1), 1, RGBAFormat);
    this.colourTexture.needsUpdate = true;
    this.uniforms = { colours: { value: this.colourTexture }, section: { value: new Vector4(0, 0, 0, 1) }, lit: { value: new Vector2(-1, -1) } };
  }

  // A surface that is drawn wherever the camera looks.
  static surfaceOf(geometry, material) { return Object.assign(new Mesh(geometry, material), { frustumCulled: false }); }

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
    this.refresh();
  }

  // Colour what was cut; `of(t)` returns r, g, b (0 to 255) of a time.
  paint(of) {
    this.ends.forEach((t, s) => this.colours.set(of(t), 4 * s));
    this.colourTexture.needsUpdate = true;
  }

  light(from, to) { this.uniforms.lit.value.set(after(this.ends, from + 1e-6), after(this.ends, to + 1e-6)); }

  // Leave out what is beyond a plane across an axis; null for all.
  cutAt(axis, at) { this.uniforms.section.value.set(axis === 0 ? 1 : 0, axis === 1 ? -1 : 0, 0, axis === null ? 1 : axis === 1 ? -at : at); }

  get isSection() { const { value: out } = this.uniforms.section; return Math.abs(out.x) + Math.abs(out.y) + Math.abs(out.z) > 0; }

  isLeftOut(place) { const { value: out } = this.uniforms.section; return out.x * place[0] + out.y * place[1] + out.z * place[2] > out.w; }

  timeOf(stamp) { return stamp ? this.ends[stamp - 1] : null; }

  seenFrom() {}

  // Where a line enters and leaves the body's box, as shares of its length: [first, last], or null.
  within(from, way) {
    let [first, last] = [0, 1];
    this.box.forEach((bounds, i) => {
      const [a, b] = bounds.map((bound) => (bound - from[i]) / (way[i] || 1e-12)).sort((p, q) => p - q);
      first = Math.max(first, a); last = Math.min(last, b);
    });
    return first < last ? [first, last] : null;
  }

  // The place of the surface on a line of sight from `from` to `to` (in the body's own frame), and the time of the cut
  // that made it: {place, t}, t null where nothing was cut; null where the line misses what is shown.
  pick(from, to) {
    const way = to.map((v, i) => v - from[i]), span = this.within(from, way), length = Math.hypot(...way);
    if (!span) return null;
    const steps = Math.ceil((span[1] - span[0]) * length / (0.5 * this.cell)) + 1;
    for (let n = 0; n <= steps; n++) {
      const share = span[0] + (span[1] - span[0]) * n / steps, place = from.map((v, i) => v + share * way[i]);
      const stamp = this.isLeftOut(place) ? null : this.stampAt(place);
      if (stamp !== null) return { place, t: this.timeOf(stamp) };
    }
    return null;
  }
}
