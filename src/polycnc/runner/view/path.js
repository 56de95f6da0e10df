// The path as lines: cuts and rapids, their colours, and which place of them is under the pointer.
import { Vector3 } from "three";
import { after } from "./format.js";
import { Lines, polyline } from "./lines.js";
import { css, paletteColour, rgb, scaled } from "./theme.js";

const NEAR = 0.35;

export class Path {
  constructor(record) {
    this.record = record;
    const swap = record.about.lathe;
    this.place = (tip) => (swap ? [tip[2], 0, tip[0]] : tip); // of the picture: a lathe lies with z to the right
    const { points } = record;
    this.at = new Float32Array(3 * points);
    for (let k = 0; k < points; k++) this.at.set(this.place([0, 1, 2].map((i) => record.tipOf(k, i))), 3 * k);
    const cuts = [], rapids = [];
    for (let k = 1; k < points; k++) {
      const far = Math.hypot(...[0, 1, 2].map((i) => this.at[3 * k + i] - this.at[3 * k - 3 + i]));
      if (far < 1e-6 || record.toolOf(record.blockAt[k]) !== record.toolOf(record.blockAt[k - 1])) continue; // another tool has not come that way
      (record.rapid[k] ? rapids : cuts).push(k);
    }
    this.cuts = this.lines(cuts, 2.6, 2);
    this.rapids = this.lines(rapids, 1.2, 1);
    this.box = this.boxOf(cuts.length ? cuts : rapids);
    this.between = this.boxOf(this.nearCuts(cuts, rapids));
    this.depths = this.box[2];
    this.all = this.boxOf([...cuts, ...rapids]);
    this.tools = [...new Set([...record.about.tools.map((each) => each.tool), ...record.block_tool])].sort((a, b) => a - b);
    const cutFeeds = cuts.map((k) => record.feed[k]);
    this.topFeed = cutFeeds.reduce((top, feed) => Math.max(top, feed), 1e-9);
    this.topRapid = rapids.reduce((top, k) => Math.max(top, record.feed[k]), 0);
    this.usualFeed = this.usual(cuts);
    this.topPower = (record.power || []).reduce((top, power) => Math.max(top, power), 1e-9); // of a laser
  }

  lines(which, width, order) {
    const begin = new Float32Array(3 * which.length), end = begin.slice(), times = new Float32Array(2 * which.length);
    which.forEach((k, n) => {
      begin.set(this.at.subarray(3 * k - 3, 3 * k), 3 * n);
      end.set(this.at.subarray(3 * k, 3 * k + 3), 3 * n);
      times.set([this.record.t_s[k - 1], this.record.t_s[k]], 2 * n);
    });
    return Object.assign(new Lines(begin, end, times, { width, order }), { which });
  }

  boxOf(which) {
    const box = [0, 1, 2].map(() => [Infinity, -Infinity]);
    for (const k of which) for (const p of [k - 1, k]) for (let i = 0; i < 3; i++) {
      const v = this.at[3 * p + i];
      if (v < box[i][0]) box[i][0] = v;
      if (v > box[i][1]) box[i][1] = v;
    }
    if (this.record.about.lathe && which.length) { const r = Math.max(...box[2].map(Math.abs)); box[2] = [-r, r]; }
    return which.length ? box : [[-1, 1], [-1, 1], [-1, 1]];
  }

  // The points of cuts and of rapids from one to the next, where those go no farther from what is cut than NEAR of its size.
  nearCuts(cuts, rapids) {
    const room = NEAR * Math.max(...this.box.map(([low, high]) => high - low), 1);
    const near = (k) => this.box.every(([low, high], i) => this.at[3 * k + i] > low - room && this.at[3 * k + i] < high + room);
    const found = [...(cuts.length ? cuts : rapids)], isRapid = new Set(rapids), from = cuts[0], to = cuts[cuts.length - 1];
    for (let k = from; k < to; k++) {
      let end = k;
      while (isRapid.has(end)) end++;
      const run = Array.from({ length: end - k }, (_, n) => k + n);
      if (run.every(near)) for (const each of run) found.push(each);
      k = Math.max(end - 1, k);
    }
    return found;
  }

  usual(cuts) { // 98 % of the cutting time is at most so fast: few fast moves leave the colours to the rest
    const speeds = new Float64Array(1001), { record } = this;
    for (const k of cuts) speeds[Math.min(Math.ceil(1000 * record.feed[k] / this.topFeed), 1000)] += record.t_s[k] - record.t_s[k - 1];
    const all = speeds.reduce((sum, s) => sum + s, 0);
    let i = 0;
    for (let sum = speeds[0]; i < 1000 && sum < 0.98 * all; sum += speeds[i]) i++;
    return Math.max(i, 1) * this.topFeed / 1000;
  }

  // The way of colouring that tells most: speed where it varies, else what else there is several of.
  telling(cuts_stock) {
    const { record } = this, { which } = this.cuts;
    if (!cuts_stock) {
      const within = which.reduce((sum, k) => sum + (record.feed[k] > 0.95 * this.usualFeed ? record.t_s[k] - record.t_s[k - 1] : 0), 0);
      const all = which.reduce((sum, k) => sum + record.t_s[k] - record.t_s[k - 1], 0);
      if (within < 0.9 * all) return "speed";
    }
    const several = (of) => new Set(which.map(of)).size > 1;
    if (several((k) => record.toolOf(record.blockAt[k]))) return "tool";
    if (several((k) => record.operationAt(record.t_s[k] - 1e-6))) return "operation";
    return this.depths[1] - this.depths[0] > 1e-3 ? "depth" : "speed";
  }

  // The path after an alarm, as one line of one colour; null where there is none.
  rest() {
    const { rest_tip, rest_rapid, about } = this.record, points = rest_rapid?.length ?? 0;
    if (points < 2) return null;
    const places = [], cut = [];
    for (let k = 0; k < points; k++) {
      if (k && rest_rapid[k] && !rest_rapid[k - 1]) places.push(null);
      const at = this.place([0, 1, 2].map((i) => rest_tip[i * points + k] - about.zero[i]));
      if (k && rest_rapid[k]) { places.push(null); places.push(at); } else { places.push(at); cut.push(at); }
    }
    const lines = polyline(places, { width: 2, order: 1 });
    if (!lines.count) return null;
    return Object.assign(lines, { box: [0, 1, 2].map((i) => [Math.min(...cut.map((at) => at[i])), Math.max(...cut.map((at) => at[i]))]) });
  }

  // The greatest of stretches of equal length that a point's piece of the path covers.
  ofPoints(load) {
    const { record } = this, found = new Float32Array(record.points);
    for (let k = 1; k < record.points; k++) {
      const last = Math.min(Math.ceil(record.t_s[k] / load.stretch_s), load.values.length);
      for (let n = Math.floor(record.t_s[k - 1] / load.stretch_s + 1e-6); n < last; n++) found[k] = Math.max(found[k], load.values[n]);
    }
    return found;
  }

  // The colour (r, g, b) of a moment by a way of colouring; how hard tools cut is known more finely than by points.
  colouringAt(how) {
    const { record } = this, load = record.loads[how], of = load ? null : this.colouring(how);
    return (t) => (load ? scaled(load.at(t - 1e-6) / load.top) : of(Math.min(after(record.t_s, t - 1e-6), record.points - 1)));
  }

  // The colour (r, g, b) of a point by a way of colouring.
  colouring(how) {
    const { record } = this, classes = (of) => (k) => rgb(paletteColour(of(k)));
    const [low, high] = this.depths, load = record.loads[how];
    if (load) { const values = load.points ??= this.ofPoints(load); return (k) => scaled(values[k] / load.top); }
    return {
      power: (k) => scaled(record.power[k] / this.topPower),
      speed: (k) => scaled(record.feed[k] / this.usualFeed),
      depth: (k) => scaled((this.at[3 * k + 2] - low) / Math.max(high - low, 1e-6)),
      tool: classes((k) => this.tools.indexOf(record.toolOf(record.blockAt[k]))),
      operation: classes((k) => Math.max(record.operationAt(record.t_s[k] - 1e-6), 0)),
      kind: classes((k) => record.block_kind[record.number[record.blockAt[k]]]),
    }[how];
  }

  paint(how) {
    const of = this.colouring(how), grey = rgb(css("--rapid"));
    this.cuts.paint((n) => of(this.cuts.which[n]));
    this.rapids.paint(() => grey);
    for (const lines of [this.cuts, this.rapids]) lines.paper(css("--paper"));
  }

  // The place of the path nearest to a pixel: {t, place, far}, null where none is near. `matrix` turns the part.
  pick(stage, x, y, matrix, lines = [this.cuts, this.rapids]) {
    const near = 12, a = new Vector3(), b = new Vector3(), world = new Vector3();
    const shown = new Float32Array(3 * this.record.points);
    for (let k = 0; k < this.record.points; k++) {
      stage.project(world.fromArray(this.at, 3 * k).applyMatrix4(matrix), a);
      a.toArray(shown, 3 * k);
    }
    let best = null;
    for (const each of lines) for (const k of each.which) {
      a.fromArray(shown, 3 * k - 3); b.fromArray(shown, 3 * k);
      const dx = b.x - a.x, dy = b.y - a.y, length2 = dx * dx + dy * dy;
      const share = length2 > 0 ? Math.min(Math.max(((x - a.x) * dx + (y - a.y) * dy) / length2, 0), 1) : 1;
      const far = Math.hypot(a.x + share * dx - x, a.y + share * dy - y) + (each === this.rapids ? 3 : 0);
      const z = a.z + share * (b.z - a.z);
      if (far < near && (!best || far < best.far - 0.5 || (far < best.far + 0.5 && z < best.z))) best = { far, z, k, share };
    }
    if (!best) return null;
    const { k, share } = best, { t_s } = this.record;
    const place = [0, 1, 2].map((i) => this.at[3 * k - 3 + i] + share * (this.at[3 * k + i] - this.at[3 * k - 3 + i]));
    return { t: t_s[k - 1] + share * (t_s[k] - t_s[k - 1]), place, k, share };
  }

  // The middle of the circle that an execution of a block goes along, null where it goes along none.
  centreOf(execution) {
    const { record } = this;
    if (record.about.kinds[record.block_kind[record.number[execution]]] !== "arc") return null;
    const from = record.start_s[execution], span = record.endOf(execution) - from;
    const [a, b, c, d] = [0.2, 0.5, 0.8, 0.35].map((share) => new Vector3(...this.place(record.at(from + share * span).tip)));
    const u = b.clone().sub(a), v = c.clone().sub(a), across = u.clone().cross(v), size = 2 * across.lengthSq();
    if (size < 1e-12) return null;
    const to = across.clone().cross(u).multiplyScalar(v.lengthSq()).add(v.clone().cross(across).multiplyScalar(u.lengthSq())).divideScalar(size);
    const centre = a.clone().add(to);
    return Math.abs(centre.distanceTo(d) - to.length()) < 0.03 ? centre.toArray() : null; // no helix
  }

  centres() { return this.middles ??= Array.from({ length: this.record.executions }, (_, execution) => this.centreOf(execution)).filter(Boolean); }

  // The points of an execution of a block, its ends included.
  pointsOf(execution) {
    const { record } = this, from = record.start_s[execution], to = record.endOf(execution);
    const places = [this.place(record.at(from).tip)];
    for (let k = after(record.t_s, from); k < record.points && record.t_s[k] < to; k++) places.push([...this.at.subarray(3 * k, 3 * k + 3)]);
    places.push(this.place(record.at(to).tip));
    return places;
  }
}
