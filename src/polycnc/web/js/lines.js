// Lines as wide as one likes, each piece with colours and times at its ends: what is not yet done is drawn faint.
import { Box3, BufferAttribute, Color, DoubleSide, InstancedBufferAttribute, InstancedBufferGeometry, LinearSRGBColorSpace, Mesh, ShaderMaterial, Sphere, Vector2, Vector3 } from "three";

const VERTEX = `
attribute vec3 begin, end, colour;
attribute vec2 times;
uniform vec2 size;
uniform float width, lift;
varying vec3 shade;
varying float time;
void main() {
  vec4 a = projectionMatrix * modelViewMatrix * vec4(begin, 1.0);
  vec4 b = projectionMatrix * modelViewMatrix * vec4(end, 1.0);
  vec2 way = (b.xy - a.xy) * size;
  float far = length(way);
  vec2 along = far > 1e-6 ? way / far : vec2(1.0, 0.0);
  vec2 off = (vec2(-along.y, along.x) * position.x + along * (position.y * 2.0 - 1.0) * 0.5) * width / size;
  gl_Position = mix(a, b, position.y);
  gl_Position.xy += off * gl_Position.w;
  gl_Position.z -= lift * gl_Position.w; // parallel lines of sight: a fixed part of the depth
  shade = colour;
  time = mix(times.x, times.y, position.y);
}`;
const FRAGMENT = `
uniform float now, faint, opacity;
uniform vec3 paper;
varying vec3 shade;
varying float time;
void main() {
  float share = time > now ? faint : 1.0;
  if (share <= 0.0) discard;
  gl_FragColor = vec4(mix(paper, shade, share), opacity);
}`;

export class Lines {
  // `begin` and `end` [3 * n], `times` [2 * n]; `width` in pixels
  constructor(begin, end, times, { width = 2.5, order = 0 } = {}) {
    const geometry = new InstancedBufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array([-1, 0, 0, 1, 0, 0, 1, 1, 0, -1, 1, 0]), 3));
    geometry.setIndex([0, 1, 2, 0, 2, 3]);
    geometry.setAttribute("begin", new InstancedBufferAttribute(begin, 3));
    geometry.setAttribute("end", new InstancedBufferAttribute(end, 3));
    geometry.setAttribute("times", new InstancedBufferAttribute(times, 2));
    this.colours = new Uint8Array(begin.length);
    geometry.setAttribute("colour", new InstancedBufferAttribute(this.colours, 3, true));
    geometry.boundingSphere = new Sphere(new Vector3(), Infinity);
    geometry.boundingBox = new Box3();
    this.count = begin.length / 3;
    this.geometry = geometry;
    this.material = new ShaderMaterial({
      vertexShader: VERTEX, fragmentShader: FRAGMENT, side: DoubleSide, transparent: true,
      uniforms: { size: { value: new Vector2(1, 1) }, width: { value: width }, lift: { value: 2e-5 * Math.max(order, 0) }, now: { value: Infinity }, faint: { value: 1 }, opacity: { value: 1 }, paper: { value: new Color() } },
    });
    this.mesh = new Mesh(geometry, this.material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = order;
  }

  // Set the colours; `of(i)` returns r, g, b (0 to 255) of a piece.
  paint(of) {
    for (let i = 0; i < this.count; i++) this.colours.set(of(i), 3 * i);
    this.geometry.attributes.colour.needsUpdate = true;
  }

  fit(stage) { this.material.uniforms.size.value.set(stage.width, stage.height); }
  set(name, value) { this.material.uniforms[name].value = value; }
  paper(colour) { this.material.uniforms.paper.value.setHex(parseInt(colour.slice(1), 16), LinearSRGBColorSpace); }
}

// A few straight lines of one colour: places [[x, y, z], ...], each joined to the next; null breaks the line.
export function polyline(places, options) {
  const begin = [], end = [];
  for (let i = 1; i < places.length; i++) if (places[i - 1] && places[i]) { begin.push(...places[i - 1]); end.push(...places[i]); }
  return new Lines(new Float32Array(begin), new Float32Array(end), new Float32Array(begin.length / 3 * 2), options);
}
