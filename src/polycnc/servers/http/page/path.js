// Where the tool is, where it has been, and where the program goes: faint before it is done, bold afterwards.
import { Stage, directions } from "/web/stage.js";
import { Lines, polyline } from "/web/lines.js";
import { toolShape } from "/web/tool_shape.js";
import { TEXTS } from "/texts.js";

const MOST_TRAIL = 3000, LEAST_MM = 0.02, LEAST_BOX_MM = 20, PART = 1 / 9;

// A colour of the page's style as #rrggbb: styles may name others, or one for light and one for dark.
export function colour(name) {
  const probe = document.createElement("span");
  probe.style.color = `var(${name})`;
  document.body.append(probe);
  const parts = getComputedStyle(probe).color.match(/[\d.]+/g).slice(0, 3);
  probe.remove();
  return `#${parts.map((part) => Math.round(Number(part)).toString(16).padStart(2, "0")).join("")}`;
}

export class Path {
  constructor(holder, tools) {
    this.holder = holder;
    this.caption = document.createElement("p");
    this.caption.className = "hint";
    try { this.stage = new Stage(holder); } catch { this.caption.textContent = TEXTS.no_picture; }
    holder.append(this.caption);
    this.clear();
    if (!this.stage) return;
    tools.append(...directions.map((name) => {
      const button = document.createElement("button");
      button.textContent = TEXTS.views[name] ?? name;
      button.onclick = () => { this.touched = false; this.from = name; this.fit(); };
      return button;
    }));
    this.stage.controls.addEventListener("start", () => { this.touched = true; });
    this.stage.before.push(() => { for (const lines of [this.way, this.trail]) lines?.fit(this.stage); });
    document.addEventListener("theme", () => this.dress());
    this.dress();
  }

  clear() {
    this.from = directions[0];
    this.touched = false;
    this.axes = null;
    this.places = [];
    this.done = 0;
    this.box = null;
    this.show(null);
  }

  // The axes that are drawn as x, y and z: those of these names, else the first that go straight.
  choose(axes) {
    const straight = Object.keys(axes).filter((name) => axes[name].unit !== "deg");
    const named = ["X", "Y", "Z"].map((name) => (straight.includes(name) ? name : null));
    this.axes = named.some(Boolean) ? named : [0, 1, 2].map((k) => straight[k] ?? null);
  }

  place(of) { return this.axes.map((name) => (name ? of(name) : 0)); }

  // Show where a program goes: what REST says of its path, or null.
  show(preview, said = "") {
    this.preview = preview;
    this.done = 0;
    if (!this.stage) return;
    this.caption.textContent = said;
    Object.assign(this.holder.dataset, { points: preview?.t_s.length ?? 0, done: 0 });
    if (this.way) this.stage.scene.remove(this.way.mesh);
    this.way = null;
    if (preview && this.axes && preview.t_s.length > 1) {
      const count = preview.t_s.length - 1;
      this.points = preview.t_s.map((_, k) => this.place((name) => preview.positions[name][k]));
      const times = new Float32Array(2 * count);
      for (let k = 0; k < count; k++) times.set([preview.t_s[k], preview.t_s[k + 1]], 2 * k);
      this.way = new Lines(new Float32Array(this.points.slice(0, -1).flat()), new Float32Array(this.points.slice(1).flat()), times, { width: 2 });
      this.way.set("faint", 0.28);
      this.way.set("now", 0);
      this.stage.scene.add(this.way.mesh);
      this.box = null;
      for (const point of this.points) this.grow(point);
    }
    this.dress();
    this.fit();
  }

  dress() {
    if (!this.stage) return;
    const paper = colour("--card"), act = colour("--act"), rapid = colour("--dim"), parts = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
    this.stage.paper(paper);
    if (this.way) {
      const [cut, fast] = [parts(act), parts(rapid)];
      this.way.paint((k) => (this.preview.rapid[k + 1] ? fast : cut));
      this.way.paper(paper);
    }
    this.drawTrail();
    this.stage.draw();
  }

  grow(point) {
    this.box ??= point.map((value) => [value, value]);
    point.forEach((value, k) => { this.box[k][0] = Math.min(this.box[k][0], value); this.box[k][1] = Math.max(this.box[k][1], value); });
  }

  fit() {
    if (!this.stage || !this.box) return;
    const box = this.box.map(([low, high]) => { const room = Math.max(0, LEAST_BOX_MM - (high - low)) / 2; return [low - room, high + room]; });
    const size = Math.hypot(...box.map(([low, high]) => high - low));
    if (this.tool) this.stage.scene.remove(this.tool);
    this.tool = toolShape(null, size * PART, colour("--hold"));
    this.stage.scene.add(this.tool);
    if (this.places.length) this.tool.position.set(...this.places.at(-1));
    if (!this.touched) this.stage.look(this.from, box, 0.95);
    this.fitted = structuredClone(box);
    this.stage.draw();
  }

  // The machine is here, and executes this line (0: none) of the program that is shown.
  at(axes, line, running) {
    if (this.axes?.some((name) => name && !(name in axes))) this.clear(); // they are those of another channel
    if (!this.axes) this.choose(axes);
    const here = this.place((name) => axes[name].machine), last = this.places.at(-1);
    if (!last || Math.hypot(...here.map((value, k) => value - last[k])) > LEAST_MM) {
      this.places.push(here);
      if (this.places.length > MOST_TRAIL) this.places.splice(0, MOST_TRAIL / 4);
      this.grow(here);
      if (!this.stage) return;
      if (!this.fitted || here.some((value, k) => value < this.fitted[k][0] || value > this.fitted[k][1])) {
        this.box = this.box.map(([low, high]) => [low - (high - low) * PART, high + (high - low) * PART]);
        this.fit();
      }
      this.tool?.position.set(...here);
      this.drawTrail();
      this.stage.draw();
    }
    if (this.way && running) this.mark(here, line);
  }

  // What is done reaches to the nearest place of the running line's path, from where it was before if it can.
  mark(here, line) {
    const { points, preview } = this, far = (k) => Math.hypot(...points[k].map((value, axis) => value - here[axis]));
    const nearest = (fits) => {
      let found = -1, least = Infinity;
      for (let k = 0; k < points.length; k++) if (fits(k) && far(k) < least - 1e-6) { least = far(k); found = k; }
      return [found, least];
    };
    const of = (k) => !line || preview.line[k] === line || preview.line[k + 1] === line;
    let [found, least] = nearest((k) => k >= this.done && of(k));
    const [anew, lessFar] = nearest(of);
    if (found < 0 || lessFar < least - Math.max(1, 0.02 * least)) found = anew; // it has begun again
    if (found < 0 || found === this.done) return;
    this.done = found;
    this.holder.dataset.done = preview.t_s[found];
    this.way.set("now", preview.t_s[found]);
    this.stage.draw();
  }

  drawTrail() {
    if (!this.stage || this.places.length < 2) return;
    if (this.trail) { this.stage.scene.remove(this.trail.mesh); this.trail.geometry.dispose(); this.trail.material.dispose(); }
    this.trail = polyline(this.places, { width: 3.5, order: 1 });
    const hex = colour("--hold"), parts = [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
    this.trail.paint(() => parts);
    this.trail.paper(colour("--card"));
    this.stage.scene.add(this.trail.mesh);
  }
}
