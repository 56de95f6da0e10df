// The pages below the screen: tools, offsets, parameters, variables, alarms, snapshots; a tab each beside the programs.
import { TEXTS } from "/texts.js";

const TOOL = ["length_mm", "radius_mm", "wear_length_mm", "wear_radius_mm"];
const OFFSETS = ["EXT", "G54", "G55", "G56", "G57", "G58", "G59"];
const MOST_ROWS = 60, WATCH_MS = 500, MOST_SHOWN = 20;

export class Pages {
  constructor(place, programs, tools) {
    Object.assign(this, tools);
    this.parts = {};
    this.status = null;
    this.panels = { programs };
    for (const name of ["tools", "offsets", "parameters", "variables", "alarms", "snapshots", "connections"]) {
      this.panels[name] = this.make("div", { id: `page-${name}`, role: "tabpanel", "aria-labelledby": `tab-${name}` });
    }
    this.tabs = Object.keys(this.panels).map((name) => this.make("button",
      { id: `tab-${name}`, role: "tab", onclick: () => this.open(name) }, TEXTS.pages[name]));
    const list = this.make("div", { role: "tablist", class: "tabs", "aria-label": TEXTS.all_pages }, ...this.tabs);
    list.addEventListener("keydown", (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key], at = this.tabs.indexOf(document.activeElement);
      if (step && at >= 0) { event.stopPropagation(); this.tabs[(at + step + this.tabs.length) % this.tabs.length].focus(); }
    });
    place.replaceChildren(list, ...Object.values(this.panels));
    this.open("programs");
  }

  open(name) {
    this.shown = name;
    for (const [each, panel] of Object.entries(this.panels)) panel.hidden = each !== name;
    for (const tab of this.tabs) tab.setAttribute("aria-selected", tab.id === `tab-${name}`);
    clearInterval(this.watching);
    this[`show_${name}`]?.();
    const again = { variables: () => this.watch(), connections: () => this.count() }[name];
    if (again) this.watching = setInterval(again, WATCH_MS);
  }

  inventory(parts) {
    Object.assign(this.parts, parts);
    if (parts[this.shown] && !this.panels[this.shown].contains(document.activeElement)) this[`show_${this.shown}`]?.();
  }

  input(value, label, change) {
    const made = this.make("input", { value: value ?? "", "aria-label": label, inputmode: "decimal", class: "cell" });
    made.addEventListener("change", async () => { made.classList.toggle("refused", !(await change(made.value.trim()))); });
    return made;
  }

  number(text, use) {
    const found = text === "" ? NaN : Number(text.replace(",", "."));
    if (Number.isFinite(found)) return use(found);
    this.say(TEXTS.no_number);
    return false;
  }

  async put(rest, body) {
    return Boolean(await this.ask(rest, { method: "PUT", body: JSON.stringify(body) }));
  }

  table(heads, rows) {
    const { make } = this;
    return make("div", { class: "wide" }, make("table", {}, make("tr", {}, ...heads.map((head) => make("th", {}, head))), ...rows));
  }

  row(head, ...cells) {
    return this.make("tr", {}, this.make("th", { scope: "row" }, head), ...cells.map((cell) => this.make("td", {}, cell ?? "")));
  }

  button(id, text, action) { return this.make("button", { id, onclick: action }, text); }

  // -------------------------------------------------------------- tools and offsets

  show_tools() {
    const tools = this.parts.tools ?? {};
    const rows = Object.entries(tools).map(([number, tool]) => this.row(`T${number}`, ...TOOL.map((key) =>
      this.input(tool[key], `T${number} ${key}`, (value) => this.number(value, (found) => this.put(`tools/${number}`, { [key]: found }))))));
    const number = this.make("input", { id: "new-tool", inputmode: "numeric", placeholder: TEXTS.number, "aria-label": TEXTS.number, class: "cell" });
    const add = this.button("add-tool", TEXTS.add, async () => {
      if (await this.put(`tools/${encodeURIComponent(number.value)}`, { length_mm: 0 })) this.show_tools();
    });
    this.panels.tools.replaceChildren(this.table([TEXTS.number, ...TOOL.map((key) => TEXTS.tool_fields[key])], rows), number, add);
  }

  show_offsets() {
    const axes = Object.keys(this.status?.axes ?? {}), known = this.parts.offsets ?? {};
    const names = [...new Set([...OFFSETS, ...Object.keys(known)])];
    const set = (name, values) => this.put(`offsets/${encodeURIComponent(name)}`, { values });
    const rows = names.map((name) => this.row(name,
      ...axes.map((axis) => this.input(known[name]?.[axis] ?? 0, `${name} ${axis}`, (value) => this.number(value, (found) => set(name, { [axis]: found })))),
      this.button(`teach-${name}`, TEXTS.teach, async () => {
        const here = Object.fromEntries(axes.map((axis) => [axis, this.status.axes[axis].machine]));
        if (await set(name, here)) this.say(TEXTS.taught);
      })));
    this.panels.offsets.replaceChildren(this.table([TEXTS.offset, ...axes, ""], rows));
  }

  // -------------------------------------------------------------- parameters and variables

  async show_parameters() {
    const answer = await this.ask("parameters");
    if (!answer) { this.panels.parameters.replaceChildren(TEXTS.none); return; }
    const all = await answer.json(), place = this.make("div", {});
    const filter = this.make("input", { id: "filter", type: "search", placeholder: TEXTS.filter, "aria-label": TEXTS.filter });
    const show = () => {
      const word = filter.value.toLowerCase();
      const found = all.filter((each) => `${each.name} ${each.what}`.toLowerCase().includes(word)).slice(0, MOST_ROWS);
      place.replaceChildren(this.table([TEXTS.number, TEXTS.value, TEXTS.meaning], found.map((each) => this.row(each.name, this.values("parameters", each), each.what))));
    };
    filter.addEventListener("input", show);
    this.panels.parameters.replaceChildren(filter, place);
    show();
  }

  values(part, each) {
    const cell = this.make("span", { class: "values" });
    const parse = (text) => (text === "" ? null : text === "true" || text === "false" ? text === "true" : Number.isNaN(Number(text)) ? text : Number(text));
    const one = (value, label, wrap) => {
      if (!each.writable) return this.make("span", {}, value === null ? "" : String(value), " ");
      return this.input(value, label, (text) => this.put(`${part}/${encodeURIComponent(each.name)}`, { value: wrap(parse(text)) }));
    };
    if (each.value && typeof each.value === "object" && !Array.isArray(each.value)) {
      for (const [axis, value] of Object.entries(each.value)) cell.append(this.make("label", {}, axis, " ", one(value, `${each.name} ${axis}`, (found) => ({ [axis]: found }))));
    } else cell.append(one(Array.isArray(each.value) ? each.value.join(", ") : each.value, each.name, (found) => found));
    return cell;
  }

  show_variables() {
    const names = this.make("input", { id: "watched", placeholder: TEXTS.watch, "aria-label": TEXTS.watch, value: localStorage.getItem("watched") ?? "" });
    names.addEventListener("change", () => { localStorage.setItem("watched", names.value); this.watch(); });
    this.watched = this.make("div", {});
    this.panels.variables.replaceChildren(names, this.watched);
    this.watch();
  }

  async watch() {
    if (this.panels.variables.querySelector(".cell:focus") || document.hidden) return;
    const names = localStorage.getItem("watched") ?? "";
    const answer = await this.ask(`variables?names=${encodeURIComponent(names)}`);
    if (!answer) { clearInterval(this.watching); return; }
    const rows = (await answer.json()).slice(0, MOST_ROWS).map((each) => this.row(each.name, this.values("variables", each), each.what));
    this.watched.replaceChildren(this.table([TEXTS.number, TEXTS.value, TEXTS.meaning], rows));
  }

  // -------------------------------------------------------------- alarms and snapshots

  show_alarms() {
    const now = (this.status?.alarms ?? []).map((alarm) => this.row(alarm.number < 0 ? "" : String(alarm.number), alarm.text, TEXTS.cleared[alarm.cleared_by] ?? "", TEXTS.now));
    const past = [...(this.parts.alarms ?? [])].reverse().map((alarm) => this.row(alarm.number < 0 ? "" : String(alarm.number), alarm.text, "", alarm.time ?? ""));
    this.panels.alarms.replaceChildren(this.table([TEXTS.number, TEXTS.text, TEXTS.to_do, TEXTS.time], [...now, ...past]),
      this.button("clear-alarms", TEXTS.forget_all, () => this.command("clear_alarm_history")));
  }

  // -------------------------------------------------------------- who is connected

  show_connections() {
    const name = this.make("input", { id: "operator", value: this.lease.operator, maxlength: "40", "aria-label": TEXTS.your_name });
    name.addEventListener("change", () => { this.lease.operator = name.value; if (this.lease.mine) this.lease.hold(true); });
    this.doors = this.make("div", {});
    this.panels.connections.replaceChildren(this.make("label", {}, TEXTS.your_name, " ", name), this.doors);
    this.count();
  }

  async count() {
    if (document.hidden) return;
    const answer = await this.ask("connections");
    if (!answer) { clearInterval(this.watching); return; }
    const rows = (await answer.json()).map((each) => this.row(each.door, each.address, String(each.clients.length), each.clients.slice(0, MOST_SHOWN).join(", ")));
    this.doors.replaceChildren(this.table([TEXTS.door, TEXTS.address, TEXTS.number, TEXTS.clients], rows));
  }

  async show_snapshots() {
    const answer = await this.ask("snapshots"), kept = answer ? await answer.json() : [];
    const name = this.make("input", { id: "snapshot-name", value: "snapshot", "aria-label": TEXTS.name });
    const post = async (rest, body) => { if (await this.ask(rest, { method: "POST", body: JSON.stringify(body) })) this.show_snapshots(); };
    const rows = kept.map((each) => this.row(each.name, String(each.cycle),
      this.button(`restore-${each.name}`, TEXTS.restore, () => post("restore", { name: each.name })),
      this.button(`forget-${each.name}`, TEXTS.forget, async () => {
        if (await this.ask(`snapshots/${encodeURIComponent(each.name)}`, { method: "DELETE" })) this.show_snapshots();
      })));
    this.panels.snapshots.replaceChildren(name, this.button("keep", TEXTS.keep, () => post("snapshot", { name: name.value })),
      this.table([TEXTS.name, TEXTS.cycle, "", ""], rows));
  }
}
