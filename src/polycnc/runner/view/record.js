// The data of a view: what the arrays mean, and where everything is at a moment.
import { Matrix4, Vector3 } from "three";
import { after } from "./format.js";

const ARRAYS = { f8: Float64Array, f4: Float32Array, i4: Int32Array, u2: Uint16Array, u1: Uint8Array };

export class Record {
  constructor(buffers) {
    this.about = JSON.parse(new TextDecoder().decode(buffers.about));
    for (const [name, at] of Object.entries(this.about.columns)) this[name] = new ARRAYS[at.type](buffers.data, at.at, at.length);
    this.points = this.t_s.length;
    this.executions = this.start_s.length;
    this.loads = {}; // how hard tools cut, in stretches of equal length
    for (const name of ["rate", "axial", "radial", "chip"]) {
      const values = this[`load_${name}`], stretch_s = this.about.load_s;
      if (values) this.loads[name] = { values, stretch_s, top: values.reduce((top, value) => Math.max(top, value), 1e-9), at: (t) => values[Math.min(Math.max(Math.floor(t / stretch_s), 0), values.length - 1)] };
    }
    this.end_s = this.points ? this.t_s[this.points - 1] : 0;
    this.axes = this.about.axes;
    this.blockAt = new Int32Array(this.points); // the execution of each point
    for (let k = 0, e = 0; k < this.points && this.executions; k++) {
      while (e + 1 < this.executions && this.start_s[e + 1] < this.t_s[k] - 1e-6) e++;
      this.blockAt[k] = e;
    }
  }

  positionOf(point, axis) { return this.position[axis * this.points + point]; }

  // The tip of the tool on the part at a point, from program zero.
  tipOf(point, i) {
    const { tips, zero } = this.about, raw = tips ? (tips[i] === null ? 0 : this.position[tips[i] * this.points + point]) : this.tip[i * this.points + point];
    return raw - zero[i];
  }

  toolOf(execution) { return this.executions ? this.block_tool[this.number[execution]] : 0; }
  executionAt(t) { return Math.max(after(this.start_s, t - 1e-6) - 1, 0); }
  rowOf(execution) { return this.executions ? this.block_row[this.number[execution]] : -1; }
  endOf(execution) { return execution + 1 < this.executions ? this.start_s[execution + 1] : this.end_s; }
  operationAt(t) { const all = this.about.operations; let i = all.length - 1; while (i > 0 && all[i].start_s > t + 1e-9) i--; return i; }

  // Positions of all axes, the tip and the speed at a moment.
  at(t) {
    const next = Math.min(Math.max(after(this.t_s, t), 1), this.points - 1), last = Math.max(next - 1, 0);
    const span = this.t_s[next] - this.t_s[last], share = span > 0 ? Math.min(Math.max((t - this.t_s[last]) / span, 0), 1) : 0;
    const between = (of) => of(last) + (of(next) - of(last)) * share;
    return {
      axes: this.axes.map((_, i) => between((k) => this.positionOf(k, i))),
      tip: [0, 1, 2].map((i) => between((k) => this.tipOf(k, i))),
      feed: between((k) => this.feed[k]),
    };
  }

  zeroAt(t) { // of each axis
    const zeros = this.zero_s.length, n = Math.max(after(this.zero_s, t - 1e-6) - 1, 0);
    return this.axes.map((_, i) => (zeros ? this.zero[i * zeros + n] : 0));
  }

  otherAt(t) { // the tip beside it
    const n = this.other_t_s.length, k = Math.min(after(this.other_t_s, t), n - 1), j = Math.max(k - 1, 0), span = this.other_t_s[k] - this.other_t_s[j];
    const share = span > 0 ? Math.min(Math.max((t - this.other_t_s[j]) / span, 0), 1) : 0;
    return [0, 1, 2].map((i) => { const of = (p) => this.other_tip[i * n + p]; return of(j) + share * (of(k) - of(j)) - this.about.zero[i]; });
  }

  // How the machine has turned part and tool: matrices for both, about program zero.
  turned(axes) {
    const { chain, zero } = this.about, part = new Matrix4(), tool = new Matrix4();
    for (const each of chain) {
      const about = new Vector3(...each.about).normalize(), angle = axes[each.axis] * Math.PI / 180;
      if (each.carries === "part") {
        const centre = new Vector3(...each.center).sub(new Vector3(...zero));
        const step = new Matrix4().makeTranslation(...centre.toArray()).multiply(new Matrix4().makeRotationAxis(about, -angle)).multiply(new Matrix4().makeTranslation(...centre.clone().negate().toArray()));
        part.multiply(step);
      } else tool.multiply(new Matrix4().makeRotationAxis(about, angle));
    }
    return { part, tool };
  }
}
