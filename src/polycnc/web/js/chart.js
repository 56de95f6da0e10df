// A chart over time that draws nothing but what is there: lines through the points, and where they are too many for
// the width, a band from the lowest to the highest with the mean in it.
import uPlot from "uplot";
import { after } from "./format.js";

// Thin points to at most 3 for each of `columns` stretches. Every value of line, low and high is one of `y`.
export function thinned(x, y, from, to, columns) {
  const found = { x: [], line: [], low: [], high: [], mean: [] };
  const push = (...values) => Object.keys(found).forEach((name, i) => found[name].push(values[i]));
  const first = Math.max(after(x, from) - 1, 0), last = Math.min(after(x, to) + 1, x.length);
  const width = (to - from) / columns;
  for (let k = first; k < last;) {
    const column = Math.floor((x[k] - from) / width), begin = k;
    let low = Infinity, high = -Infinity, area = 0;
    for (; k < last && (k === begin || Math.floor((x[k] - from) / width) === column); k++) {
      if (y[k] < low) low = y[k];
      if (y[k] > high) high = y[k];
      if (k > begin) area += (x[k] - x[k - 1]) * (y[k] + y[k - 1]) / 2;
    }
    if (k - begin <= 4) {
      for (let j = begin; j < k; j++) push(x[j], y[j], null, null, null);
      continue;
    }
    const mean = area / Math.max(x[k - 1] - x[begin], 1e-12);
    push(x[begin], y[begin], low, high, mean);
    push((x[begin] + x[k - 1]) / 2, null, low, high, mean);
    push(x[k - 1], y[k - 1], low, high, mean);
    if (k < last) push((x[k - 1] + x[k]) / 2, undefined, null, null, null); // the band ends, the line goes on
  }
  return found;
}

export class Chart {
  constructor(holder, { onTime, colours }) {
    this.holder = holder;
    this.colours = colours;
    this.onTime = onTime;
    this.window = null;
    new ResizeObserver(() => { if (this.plot) { this.plot.setSize(this.size); this.refill(); } }).observe(holder);
  }

  get size() { return { width: Math.max(this.holder.clientWidth, 50), height: Math.max(this.holder.clientHeight, 50) }; }

  // Show points over time; `top` cuts the chart off above, `zero` keeps 0 in it.
  show({ x, y, end, unit, top = null, zero = false }) {
    this.points = { x, y };
    this.end = end;
    this.window = this.window ?? [0, end];
    this.plot?.destroy();
    const { line, band, soft, grid } = this.colours();
    const axis = { stroke: soft, grid: { stroke: grid, width: 1 }, ticks: { stroke: grid, width: 1 }, font: "12px system-ui" };
    const range = (u, low, high) => {
      if (top !== null) return [0, top];
      const [from, to] = [zero ? Math.min(low ?? 0, 0) : low ?? 0, high ?? 1], room = 0.06 * Math.max(to - from, 1e-6);
      return [zero && from === 0 ? 0 : from - room, to + room];
    };
    const clear = { points: { show: false } };
    this.plot = new uPlot({
      ...this.size, legend: { show: false }, padding: [10, 24, 0, 0],
      scales: { x: { time: false, range: () => this.window }, y: { range } },
      axes: [{ ...axis, size: 30, values: (u, all) => all.map((t) => `${Number(t.toFixed(6))} s`) }, { ...axis, size: 62, label: unit, labelSize: 16, labelFont: "12px system-ui" }],
      series: [{}, { ...clear, stroke: line, width: 1.5 }, { ...clear, stroke: band, width: 0 }, { ...clear, stroke: band, width: 0 }, { ...clear, stroke: line, width: 1.5 }],
      bands: [{ series: [3, 2], fill: band }],
      cursor: { drag: { x: true, y: false, setScale: false }, points: { show: false }, y: false },
      hooks: {
        setSelect: [(u) => {
          if (u.select.width < 4) return;
          this.zoom(u.posToVal(u.select.left, "x"), u.posToVal(u.select.left + u.select.width, "x"));
          u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
        }],
        draw: [(u) => this.drawNow(u)],
      },
    }, this.fill(), this.holder);
    this.plot.over.addEventListener("click", (event) => {
      const at = event.clientX - this.plot.over.getBoundingClientRect().left;
      if (Math.abs(at - (this.down ?? at)) < 4) this.onTime(this.plot.posToVal(at, "x"));
    });
    this.plot.over.addEventListener("mousedown", (event) => { this.down = event.clientX - this.plot.over.getBoundingClientRect().left; });
    this.plot.over.addEventListener("dblclick", () => this.zoom(0, this.end));
  }

  fill() {
    const [from, to] = this.window, columns = Math.max(Math.floor(this.size.width / 2), 20);
    this.drawn = thinned(this.points.x, this.points.y, from, to, columns);
    return [this.drawn.x, this.drawn.line, this.drawn.low, this.drawn.high, this.drawn.mean];
  }

  refill() { this.plot.setData(this.fill(), true); }
  zoom(from, to) { this.window = [Math.max(from, 0), Math.min(to, this.end)]; this.refill(); }
  now(t) { this.t = t; if (this.plot && !this.waiting) { this.waiting = true; requestAnimationFrame(() => { this.waiting = false; this.plot.redraw(false, false); }); } }

  drawNow(u) {
    const x = u.valToPos(this.t ?? 0, "x", true), { ctx, bbox } = u;
    if (x < bbox.left || x > bbox.left + bbox.width) return;
    ctx.save();
    ctx.fillStyle = this.colours().now;
    ctx.fillRect(x - 1, bbox.top, 2 * devicePixelRatio, bbox.height);
    ctx.restore();
  }
}
