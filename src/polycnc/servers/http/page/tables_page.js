// Tools and work offsets: edited in place, and taught from where the axes are.
import { button, make, row, say, table } from "/dom.js";
import { Page } from "/page_base.js";
import { TEXTS } from "/texts.js";

const MILL = ["length_mm", "radius_mm", "wear_length_mm", "wear_radius_mm"], LATHE = ["x_mm", "z_mm", "wear_x_mm", "wear_z_mm", "radius_mm", "tip"];
const OFFSETS = ["EXT", "G54", "G55", "G56", "G57", "G58", "G59"], SHIFT = "EXT";
const rounded = (value) => Number(value.toFixed(6));

class Tools extends Page {
  static follows = ["tools"];
  static needs = "control";
  show() {
    const tools = this.parts.tools ?? {}, any = Object.values(tools)[0] ?? {}, axes = Object.keys(this.link.status?.axes ?? {});
    const fields = [...(axes.includes("Y") || !axes.includes("X") ? MILL : LATHE)].filter((key) => key in any || !Object.keys(any).length);
    const set = (number, values) => this.send("PUT", `tools/${encodeURIComponent(number)}`, values);
    const rows = Object.entries(tools).map(([number, tool]) => row(`T${number}`,
      ...fields.map((key) => this.input(tool[key], `T${number} ${key}`, (value) => this.number(value, (found) => set(number, { [key]: found })))),
      tool.description ?? "",
      fields.includes("length_mm") && axes.includes("Z") ? button(`touch-${number}`, TEXTS.touch, () => this.touch(number, set)) : "",
      button(`remove-tool-${number}`, TEXTS.remove, () => this.send("DELETE", `tools/${number}`))));
    const number = make("input", { id: "new-tool", inputmode: "numeric", placeholder: TEXTS.number, "aria-label": TEXTS.number, class: "cell" });
    const add = button("add-tool", TEXTS.add, async () => { if (await set(number.value.trim(), { length_mm: 0 })) this.renew(); });
    this.replaceChildren(!rows.length ? TEXTS.none : table([TEXTS.number, ...fields.map((key) => TEXTS.tool_fields[key]), TEXTS.text, "", ""], rows), make("p", { class: "row" }, number, add), make("p", { class: "hint" }, TEXTS.touch_hint));
  }

  // The tool touches Z 0 of the work offset in force: what is left of Z is its length.
  async touch(number, set) {
    const { axes } = this.link.status, channel = this.link.status.channels[this.link.channel];
    if (await set(number, { length_mm: rounded(axes.Z.work + channel.tool.compensation_mm) })) say(TEXTS.touched);
    this.renew();
  }
}
customElements.define("cnc-page-tools", Tools);

class Offsets extends Page {
  static follows = ["offsets"];
  static needs = "control";
  show() {
    const axes = Object.keys(this.link.status?.axes ?? {}), known = this.parts.offsets ?? {};
    const names = [...new Set([...OFFSETS, ...Object.keys(known)])];
    const rows = names.map((name) => row(name,
      ...axes.map((axis) => make("span", { class: "values" },
        this.input(known[name]?.[axis] ?? 0, `${name} ${axis}`, (value) => this.number(value, (found) => this.set(name, { [axis]: found }))),
        name === SHIFT ? "" : make("button", { class: "small", id: `teach-${name}-${axis}`, title: `${TEXTS.taught} (${axis})`, "aria-label": `${TEXTS.teach} ${name} ${axis}`, onclick: () => this.teach(name, [axis]) }, "◎"))),
      name === SHIFT ? "" : button(`teach-${name}`, TEXTS.teach, () => this.teach(name, axes))));
    this.replaceChildren(table([TEXTS.offset, ...axes, ""], rows), make("p", { class: "hint" }, TEXTS.teach_hint));
  }
  set(name, values) { return this.send("PUT", `offsets/${encodeURIComponent(name)}`, { values }); }

  // Program zero is where the axes are: what the external shift and the tool's length in force add is taken off.
  async teach(name, axes) {
    const { axes: now } = this.link.status, channel = this.link.status.channels[this.link.channel], shift = this.parts.offsets?.[SHIFT] ?? {};
    const added = (axis) => (shift[axis] ?? 0) + (axis === "Z" ? channel.tool.compensation_mm : 0);
    if (await this.set(name, Object.fromEntries(axes.map((axis) => [axis, rounded(now[axis].machine - added(axis))])))) say(TEXTS.taught);
    this.renew();
  }
}
customElements.define("cnc-page-offsets", Offsets);
