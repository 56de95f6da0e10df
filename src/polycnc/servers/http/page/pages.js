// The pages below the screen: tools, offsets, parameters, variables, alarms, snapshots; a tab each beside the programs.
import { TEXTS } from "/texts.js";

const TOOL = ["length_mm", "radius_mm", "wear_length_mm", "wear_radius_mm"];
const OFFSETS = ["EXT", "G54", "G55", "G56", "G57", "G58", "G59"];
const MOST_ROWS = 60, WATCH_MS = 500, MOST_SHOWN = 20;
const PAGES = ["tools", "offsets", "parameters", "variables", "signals", "screen", "tasks", "alarms", "snapshots", "connections"];
const NEEDS = { tools: "control", offsets: "control", alarms: "control", parameters: "parameters", variables: "variables", signals: "signals", screen: "screen", tasks: "tasks" };
const KEYS_OF = { Enter: "ENTER", Delete: "DELETE", Backspace: "DELETE", ArrowUp: "CURSOR_UP", ArrowDown: "CURSOR_DOWN", ArrowLeft: "CURSOR_LEFT", ArrowRight: "CURSOR_RIGHT", Escape: "LEVEL_RETURN",
  ...Object.fromEntries([1, 2, 3, 4, 5, 6, 7, 8].map((k) => [`F${k}`, `SOFTKEY${k}`])) };
const USUAL_SIGNALS = "G8, G10, G11, G12, G14, G30, G43, G46, F0, F1, X4, X8, X9, Y8, R0, K0, D0";

export class Pages {
  constructor(place, programs, tools) {
    Object.assign(this, tools);
    this.parts = {};
    this.lists = {};
    this.status = null;
    this.panels = this.parts_of_machine.includes("control") ? { programs } : {};
    for (const name of PAGES.filter((each) => !(each in NEEDS) || this.parts_of_machine.includes(NEEDS[each]))) {
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
    this.open(Object.keys(this.panels)[0]);
  }

  open(name) {
    this.shown = name;
    for (const [each, panel] of Object.entries(this.panels)) panel.hidden = each !== name;
    for (const tab of this.tabs) tab.setAttribute("aria-selected", tab.id === `tab-${name}`);
    clearInterval(this.watching);
    this[`show_${name}`]?.();
    const again = { variables: () => this.watch(), signals: () => this.see(), screen: () => this.look(), tasks: () => this.turn(), connections: () => this.count() }[name];
    if (again) this.watching = setInterval(again, WATCH_MS);
  }

  // Ask nothing any more: another machine is looked at.
  close() { clearInterval(this.watching); }

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

  show_variables() { this.list("variables", "", () => this.watch()); }
  watch() { return this.rows_of("variables", ""); }

  // A list of values to watch, whose names the viewer gives; without any it is `usual`, or all.
  list(part, usual, again) {
    const names = this.make("input", { id: `watched-${part}`, class: "watched", placeholder: TEXTS.watch[part], "aria-label": TEXTS.watch[part], value: localStorage.getItem(`watched-${part}`) ?? usual });
    names.addEventListener("change", () => { localStorage.setItem(`watched-${part}`, names.value); again(); });
    this.lists[part] = this.make("div", {});
    this.panels[part].replaceChildren(names, this.lists[part]);
    again();
  }

  async rows_of(part, usual) {
    if (this.panels[part].querySelector(".cell:focus") || document.hidden) return;
    const answer = await this.ask(`${part}?names=${encodeURIComponent(localStorage.getItem(`watched-${part}`) ?? usual)}`);
    if (!answer) { clearInterval(this.watching); return; }
    const rows = (await answer.json()).slice(0, MOST_ROWS).map((each) => this.row(each.name, this.values(part, each), each.what));
    this.lists[part].replaceChildren(this.table([TEXTS.number, TEXTS.value, TEXTS.meaning], rows));
  }

  // -------------------------------------------------------------- alarms and snapshots

  show_alarms() {
    const now = (this.status?.alarms ?? []).map((alarm) => this.row(alarm.number < 0 ? "" : String(alarm.number), alarm.text, TEXTS.cleared[alarm.cleared_by] ?? "", TEXTS.now));
    const past = [...(this.parts.alarms ?? [])].reverse().map((alarm) => this.row(alarm.number < 0 ? "" : String(alarm.number), alarm.text, "", alarm.time ?? ""));
    this.panels.alarms.replaceChildren(this.table([TEXTS.number, TEXTS.text, TEXTS.to_do, TEXTS.time], [...now, ...past]),
      this.button("clear-alarms", TEXTS.forget_all, () => this.command("clear_alarm_history")));
  }

  // -------------------------------------------------------------- what only some machines have

  show_signals() { this.list("signals", USUAL_SIGNALS, () => this.see()); }
  see() { return this.rows_of("signals", USUAL_SIGNALS); }

  show_screen() {
    const press = async (key) => {
      if (await this.ask("screen", { method: "POST", body: JSON.stringify({ key }) })) this.look();
    };
    this.shown_screen = this.make("img", { id: "screen", alt: TEXTS.pages.screen, tabindex: "0" });
    this.shown_screen.addEventListener("keydown", (event) => {
      const name = KEYS_OF[event.key] ?? (event.key.length === 1 ? event.key : null);
      if (name && !event.altKey && !event.ctrlKey && !event.metaKey) { event.preventDefault(); event.stopPropagation(); press(name); }
    });
    this.screen_keys = this.make("p", { class: "row", id: "screen-keys" });
    this.press_key = press;
    this.panels.screen.replaceChildren(this.shown_screen, this.screen_keys, this.make("p", { class: "hint" }, TEXTS.screen_hint));
    this.look();
  }

  async look() {
    if (document.hidden) return;
    const answer = await this.ask("screen");
    if (!answer) { clearInterval(this.watching); return; }
    const told = await answer.json(), text = JSON.stringify(told);
    if (this.screen_keys.dataset.told === text && this.shown_screen.src) return;
    this.screen_keys.dataset.told = text;
    this.shown_screen.src = `${this.url("screen.svg")}?at=${performance.now()}`;
    this.shown_screen.alt = told.lines.map((line) => line.trimEnd()).filter(Boolean).join("\n");
    const names = told.keys.filter((key) => !key.startsWith("SOFTKEY"));
    const soft = told.softkeys.map((label, k) => this.button(`key-SOFTKEY${k + 1}`, label.replaceAll("&", " ") || `F${k + 1}`, () => this.press_key(`SOFTKEY${k + 1}`)));
    this.screen_keys.replaceChildren(...soft, ...names.map((key) => this.button(`key-${key}`, TEXTS.keys_of_screen[key] ?? key, () => this.press_key(key))));
  }

  show_tasks() {
    this.source = this.make("textarea", { id: "source", "aria-label": TEXTS.source, spellcheck: "false", placeholder: TEXTS.source });
    this.task = this.make("select", { id: "task", "aria-label": TEXTS.task }, ...[0, 1, 2, 3].map((number) => this.make("option", {}, String(number))));
    this.shown_tasks = this.make("div", {});
    const load = async () => {
      if (await this.ask(`tasks/${this.task.value}`, { method: "PUT", body: this.source.value })) this.turn();
    };
    this.panels.tasks.replaceChildren(this.shown_tasks, this.make("p", { class: "row" }, this.task, this.button("load-task", TEXTS.load, load)), this.source);
    this.turn();
  }

  async turn() {
    if (document.hidden || this.shown_tasks.contains(document.activeElement)) return;
    const answer = await this.ask("tasks");
    if (!answer) { clearInterval(this.watching); return; }
    const give = (number, what) => this.button(`${what}-${number}`, TEXTS.tasks_do[what], async (event) => {
      event.target.blur();
      if (await this.ask(`tasks/${number}`, { method: "POST", body: JSON.stringify({ do: what }) })) this.turn();
    });
    const rows = (await answer.json()).map((each) => this.row(String(each.task), each.state, each.line ? String(each.line) : "",
      each.error_number ? `${each.error_number} ${each.error} (${TEXTS.line} ${each.error_line})` : "", give(each.task, "start"), give(each.task, "stop"), give(each.task, "continue")));
    this.shown_tasks.replaceChildren(this.table([TEXTS.task, TEXTS.state, TEXTS.line, TEXTS.error_of, "", "", ""], rows));
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
