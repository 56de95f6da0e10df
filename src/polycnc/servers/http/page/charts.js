// Speed and following error over the last minute of the machine's time.
import uPlot from "/web/uPlot.esm.js";
import { colour } from "/path.js";
import { TEXTS } from "/texts.js";

const LAST_S = 60, DRAW_MS = 250, COLOURS = ["--act", "--hold", "--go", "--bad", "--dim"];

class Chart {
  constructor(holder, title, names, least, places) {
    Object.assign(this, { least, places });
    this.holder = holder;
    this.title = title;
    this.names = names;
    this.data = [[], ...names.map(() => [])];
    this.build();
    new ResizeObserver(() => this.plot.setSize(this.size)).observe(holder);
  }
  // The height is what is left beside the head, which is title and names in their colours.
  get size() { return { width: Math.max(this.holder.clientWidth, 50), height: Math.max(80, Math.min(150, this.holder.clientHeight - 24)) }; }
  build() {
    this.plot?.destroy();
    const soft = colour("--dim"), grid = { stroke: colour("--line"), width: 1 };
    const axis = { stroke: soft, grid, ticks: grid, font: "12px system-ui" };
    const head = document.createElement("p");
    head.append(this.title, ...this.names.map((name) => Object.assign(document.createElement("b"), { textContent: name })));
    head.querySelectorAll("b").forEach((name, k) => { name.style.color = colour(COLOURS[k % COLOURS.length]); });
    this.holder.replaceChildren(head);
    this.plot = new uPlot({
      ...this.size, cursor: { show: false }, legend: { show: false },
      scales: { x: { time: false, range: () => { const now = this.data[0].at(-1) ?? 0; return [now - LAST_S, now]; } },
        y: { range: (u, low, high) => { const room = 0.08 * Math.max((high ?? 0) - (low ?? 0), this.least); return [Math.min(low ?? 0, 0) - (low < 0 ? room : 0), Math.max(high ?? 0, this.least) + room]; } } },
      axes: [{ ...axis, space: 70, values: (u, all) => all.map((t) => `${Number((t - (this.data[0].at(-1) ?? 0)).toFixed(0))} s`),
        splits: () => { const now = this.data[0].at(-1) ?? 0; return [-60, -45, -30, -15, 0].map((t) => now + t); } }, { ...axis, size: 64, space: 22, values: (u, all) => all.map((value) => value.toFixed(this.places)) }],
      series: [{}, ...this.names.map((label, k) => ({ label, stroke: colour(COLOURS[k % COLOURS.length]), width: 1.5, points: { show: false } }))],
    }, this.data, this.holder);
  }
  add(t, values) {
    const last = this.data[0].at(-1);
    if (last !== undefined && t < last) for (const column of this.data) column.length = 0; // time was set back
    if (t === last) return;
    [t, ...values].forEach((value, k) => this.data[k].push(value));
    let old = 0;
    while (this.data[0][old] < t - LAST_S - 1) old++;
    if (old) for (const column of this.data) column.splice(0, old);
  }
}

export class Charts {
  constructor(holder) {
    this.holder = holder;
    this.drawn = 0;
    document.addEventListener("theme", () => { for (const each of this.all ?? []) each.build(); });
  }
  clear() { this.all = null; }
  add(status, feed) {
    const axes = Object.keys(status.axes);
    if (!this.all || this.axes !== axes.join()) {
      this.axes = axes.join();
      const places = [0, 1].map(() => document.createElement("div"));
      this.holder.replaceChildren(...places);
      this.all = [new Chart(places[0], TEXTS.speed, [TEXTS.commanded, TEXTS.actual], 100, 0), new Chart(places[1], TEXTS.lag, axes, 0.01, 3)];
    }
    this.all[0].add(status.time_s, [feed.commanded, feed.actual]);
    this.all[1].add(status.time_s, axes.map((name) => status.axes[name].following_error));
    if (performance.now() - this.drawn < DRAW_MS || document.hidden) return;
    this.drawn = performance.now();
    for (const each of this.all) each.plot.setData(each.data);
  }
}
