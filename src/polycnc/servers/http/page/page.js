// The operator's page: one screen that shows what the stream sends and asks the commands of REST.
import { TEXTS } from "/texts.js";
import { Pages } from "/pages.js";
import { Charts } from "/charts.js";
import { Lease } from "/lease.js";
import { Path } from "/path.js";

const SWITCHES = ["single_block", "dry_run", "optional_stop", "block_delete", "machine_lock"];
const RATES = [0, 0.1, 0.5, 1, 2, 5, 10, 50];
const RATE = 20, STALE_MS = 900, AGAIN_MS = 1000, BEAT_MS = 200, MOST_LINES = 2000, REDRAW_MS = 300;
const $ = (id) => document.getElementById(id);
const make = (tag, attributes = {}, ...inside) => {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value); else made.setAttribute(name, value);
  }
  made.append(...inside);
  return made;
};
const put = (place, text) => { if (place.textContent !== text) place.textContent = text; };

class Axes extends HTMLElement {
  show(axes) {
    if (this.names !== Object.keys(axes).join()) this.build(axes);
    for (const [name, axis] of Object.entries(axes)) {
      const cells = this.cells[name];
      for (const key of ["work", "machine", "relative", "to_go"]) put(cells[key], axis[key].toFixed(3));
      put(cells.error, axis.following_error.toFixed(3));
      put(cells.load, `${axis.load_percent.toFixed(0)} %`);
      cells.name.classList.toggle("unreferenced", !axis.referenced);
    }
  }
  build(axes) {
    this.names = Object.keys(axes).join();
    this.cells = {};
    const columns = ["work", "machine", "relative", "to_go", "error", "load"];
    const optional = (key) => (["relative", "error", "load"].includes(key) ? "optional" : key);
    const head = make("tr", {}, make("th", {}, TEXTS.axis), ...columns.map((key) => make("th", { class: optional(key) }, TEXTS[key])));
    const rows = Object.keys(axes).map((name) => {
      const cells = (this.cells[name] = { name: make("th", { scope: "row" }, name) });
      for (const key of columns) cells[key] = make("td", { class: optional(key), id: `${name}-${key}` });
      return make("tr", {}, ...Object.values(cells));
    });
    this.replaceChildren(make("table", {}, head, ...rows));
  }
}
customElements.define("cnc-axes", Axes);

const state = { machine: "", status: null, socket: null, seen: 0, lines: "", held: new Map(), stamp: 0, chosen: 0, breakpoints: [] };
let pages = null;
const path = new Path($("path"), $("views")), charts = new Charts($("charts")), lease = new Lease(ask);
const url = (rest) => `/api/machines/${encodeURIComponent(state.machine)}/${rest}`;

function say(text) { put($("said"), text); clearTimeout(say.timer); say.timer = setTimeout(() => put($("said"), ""), 6000); }

async function ask(rest, options) {
  try {
    const answer = await fetch(url(rest), { ...options, headers: { "polycnc-key": lease.key } });
    if (!answer.ok) {
      const problem = await answer.json();
      say(`${problem.detail}. ${problem.hint}`);
      return null;
    }
    return answer;
  } catch { say(TEXTS.lost); return null; }
}

async function command(name, values = {}) {
  const answer = await ask("commands", { method: "POST", body: JSON.stringify({ command: name, ...values }) });
  if (answer) show(await answer.json());
  return Boolean(answer);
}

// ---------------------------------------------------------------- what is shown

function show(status) {
  state.status = status;
  if (pages) pages.status = status;
  const channel = status.channels?.[0];
  put($("clock"), `${status.time_s.toFixed(1)} s`);
  if (!channel) { showBoard(status); return; }
  put($("mode"), TEXTS.modes[status.mode] ?? status.mode);
  $("run").dataset.state = channel.run_state;
  put($("run"), channel.run_state.replaceAll("_", " "));
  document.querySelector("cnc-axes").show(status.axes);
  path.at(status.axes, channel.block?.program === state.lines ? channel.block.line : 0, ["active", "hold", "stopped"].includes(channel.run_state));
  charts.add(status, channel.feed);
  const alarms = status.alarms.map((alarm) => `${alarm.number} ${alarm.text}`).join("\n");
  if ($("alarms").dataset.said !== alarms) {
    $("alarms").dataset.said = alarms;
    $("alarms").replaceChildren(...status.alarms.map((alarm) => make("p", {}, alarm.number < 0 ? alarm.text : `${alarm.number} ${alarm.text}`)));
  }
  showWords(status, channel);
  for (const button of document.querySelectorAll("[data-mode]")) button.setAttribute("aria-pressed", button.dataset.mode === status.mode);
  for (const name of SWITCHES) {
    const on = status.switches[name];
    $(name).setAttribute("aria-pressed", Array.isArray(on) ? on.length > 0 : on);
  }
  const pressed = status.emergency === "on";
  $("stop").setAttribute("aria-pressed", pressed);
  put($("stop"), pressed ? TEXTS.release : TEXTS.stop);
  for (const key of document.querySelectorAll("[data-jog]")) key.disabled = !["jog", "inc", "ref"].includes(status.mode) || (status.mode === "ref" && key.dataset.way === "-1");
  showLine(channel);
}

// A board or card has no control: its axes and bits as its status has them.
function showBoard(status) {
  const { axes, cycle, time_s, ...others } = status, columns = Object.keys(axes[0] ?? {});
  const number = (value) => (typeof value === "number" && !Number.isInteger(value) ? value.toFixed(3) : String(value));
  const rows = axes.map((axis, index) => make("tr", {}, make("th", { scope: "row" }, String(index)), ...columns.map((key) => make("td", {}, number(axis[key])))));
  const bits = Object.entries(others).map(([name, value]) => make("tr", {}, make("th", { scope: "row" }, name), make("td", {}, number(value))));
  document.querySelector("cnc-axes").replaceChildren(
    make("table", {}, make("tr", {}, make("th", {}, TEXTS.axis), ...columns.map((key) => make("th", {}, key))), ...rows), make("table", { class: "bits" }, ...bits));
}

function showWords(status, channel) {
  const feed = channel.feed, spindle = status.spindle;
  const figures = [feed.programmed, feed.commanded, feed.actual, spindle.programmed_rpm ?? 0, spindle.commanded_rpm ?? 0, spindle.actual_rpm ?? 0];
  for (const [index, value] of figures.entries()) put($(`figure${index}`), Number(value).toFixed(0));
  put($("tool"), `T${channel.tool.number}`);
  const modal = channel.modal, words = modal ? [...Object.values(modal.g ?? {}), ...(modal.m ?? []).map((code) => `M${code}`)] : [];
  put($("modal"), words.filter((word) => typeof word === "string").join(" "));
  for (const name of ["feed", "rapid", "spindle"]) {
    const slider = $(`override-${name}`), value = Math.round(status.overrides[name] * 100);
    if (document.activeElement !== slider) slider.value = value;
    put($(`override-${name}-is`), `${value} %`);
  }
}

function showLine(channel) {
  const block = channel.block;
  put($("name"), [channel.program ?? TEXTS.no_program, ...channel.stack.slice(1)].join(" › "));
  if (channel.program !== state.lines) loadLines(channel.program);
  const line = block && block.program === state.lines ? block.line : 0;
  const old = $("lines").querySelector("[aria-current]"), now = line ? $("lines").children[line - 1] : null;
  if (old !== now) {
    old?.removeAttribute("aria-current");
    now?.setAttribute("aria-current", "step");
    if (now) $("lines").scrollTop = now.offsetTop - $("lines").offsetTop - $("lines").clientHeight / 2;
  }
}

async function loadLines(name) {
  state.lines = name;
  $("lines").replaceChildren();
  drawPath();
  if (!name) return;
  const answer = await fetch(url(`programs/${encodeURIComponent(name)}`)).catch(() => null);
  if (!answer?.ok || state.lines !== name) return;
  const lines = (await answer.text()).split("\n").slice(0, MOST_LINES);
  $("lines").replaceChildren(...lines.map((line, index) => make("li", { onclick: () => choose(index + 1) }, line)));
  state.chosen = 0;
  showBreakpoints();
}

// Where the selected program goes, asked anew when it, a tool or an offset has changed.
function drawPath() {
  clearTimeout(drawPath.timer);
  drawPath.timer = setTimeout(async () => {
    const name = state.lines;
    if (!name) { path.show(null); return; }
    const answer = await fetch(url(`path?program=${encodeURIComponent(name)}`)).catch(() => null);
    if (state.lines !== name || !answer) return;
    const told = await answer.json();
    path.show(answer.ok ? told : null, answer.ok ? told.errors[0] ?? "" : told.detail);
  }, REDRAW_MS);
}

function choose(line) {
  const { children } = $("lines");
  children[state.chosen - 1]?.removeAttribute("aria-selected");
  state.chosen = Math.max(1, Math.min(line, children.length));
  children[state.chosen - 1]?.setAttribute("aria-selected", "true");
  children[state.chosen - 1]?.scrollIntoView({ block: "nearest" });
  for (const id of ["from_line", "breakpoint"]) $(id).disabled = !children.length;
}
function linesWithBreakpoints() { return state.breakpoints.filter((each) => each.program === state.lines).map((each) => each.line); }
function showBreakpoints() {
  const marked = new Set(linesWithBreakpoints());
  [...$("lines").children].forEach((line, index) => line.classList.toggle("breakpoint", marked.has(index + 1)));
}
function toggleBreakpoint() {
  const there = linesWithBreakpoints(), line = state.chosen;
  command("set_breakpoints", { program: state.lines, lines: there.includes(line) ? there.filter((each) => each !== line) : [...there, line] });
}

function showInventory(parts) {
  pages?.inventory(parts);
  if (parts.breakpoints) { state.breakpoints = parts.breakpoints; showBreakpoints(); }
  if (parts.tools || parts.offsets) drawPath();
  if (!parts.programs) return;
  const chosen = $("names").value;
  $("names").replaceChildren(...parts.programs.map((entry) => make("option", { value: entry.name }, `${entry.name} ${entry.comment}`)));
  if (chosen) $("names").value = chosen;
  state.lines = "";
}

// ---------------------------------------------------------------- the stream

function connect() {
  state.socket?.close();
  const socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}${url(`stream?rate=${RATE}`)}`);
  state.socket = socket;
  socket.onmessage = (event) => {
    if (state.socket !== socket) return; // of the machine before
    const message = JSON.parse(event.data);
    if (message.refused) { say(`${message.refused.detail}. ${message.refused.hint}`); return; }
    state.seen = performance.now();
    document.body.classList.remove("lost");
    put($("connection"), TEXTS.connected);
    show(message.status);
    if (document.activeElement !== $("rate")) $("rate").value = String(message.rate);
    lease.show(message.lease);
    showInventory(message.inventory);
  };
  socket.onclose = () => { if (state.socket === socket) { releaseAll(); setTimeout(connect, AGAIN_MS); } };
}
setInterval(() => {
  if (performance.now() - state.seen > STALE_MS) {
    document.body.classList.add("lost");
    put($("connection"), TEXTS.lost);
    releaseAll();
  }
}, 250);

// ---------------------------------------------------------------- by hand

function send(axis, direction, rapid) {
  if (state.socket?.readyState === WebSocket.OPEN) state.socket.send(JSON.stringify({ jog: { axis, direction, rapid }, key: lease.key }));
}
function press(axis, direction) {
  if (!state.status) return;
  if (state.status.mode === "inc") {
    command("increment", { axis, direction, size: Number($("size").value) });
    return;
  }
  if (state.status.mode === "ref") { command("reference", { axis }); return; }
  if (state.status.mode !== "jog" || state.held.has(axis)) return;
  const rapid = $("rapidly").getAttribute("aria-pressed") === "true";
  send(axis, direction, rapid);
  state.held.set(axis, setInterval(() => send(axis, direction, rapid), BEAT_MS));
}
function release(axis) {
  if (!state.held.has(axis)) return;
  clearInterval(state.held.get(axis));
  state.held.delete(axis);
  send(axis, 0);
}
function releaseAll() { for (const axis of [...state.held.keys()]) release(axis); }

const ARROWS = { ArrowRight: ["X", 1], ArrowLeft: ["X", -1], ArrowUp: ["Y", 1], ArrowDown: ["Y", -1], PageUp: ["Z", 1], PageDown: ["Z", -1] };
const SHORT = { KeyS: "cycle_start", KeyH: "feed_hold", KeyR: "reset", KeyX: "stop" };
addEventListener("keydown", (event) => {
  if (event.altKey && SHORT[event.code]) { event.preventDefault(); $(SHORT[event.code]).click(); return; }
  const key = ARROWS[event.key];
  if (key && !event.target.matches("input, textarea, select, ol") && ["jog", "inc"].includes(state.status?.mode)) {
    event.preventDefault();
    if (!event.repeat) press(...key);
  }
});
addEventListener("keyup", (event) => { if (ARROWS[event.key]) release(ARROWS[event.key][0]); });
addEventListener("blur", releaseAll);
document.addEventListener("visibilitychange", () => { if (document.hidden) releaseAll(); });

// ---------------------------------------------------------------- what is there from the beginning

function build(axes) {
  const button = (id, action) => make("button", { id, onclick: action }, TEXTS[id] ?? id);
  put($("stop"), TEXTS.stop);
  $("stop").onclick = () => command("emergency_stop", { on: state.status?.emergency !== "on" });
  const toggled = (name) => () => {
    const on = $(name).getAttribute("aria-pressed") !== "true";
    command("set_switches", { [name]: name === "block_delete" ? (on ? [1] : []) : on });
  };
  $("keys").replaceChildren(
    ...["cycle_start", "feed_hold", "reset"].map((name) => button(name, () => command(name))),
    button("step", () => command("cycle_start", { step: "over" })),
    ...SWITCHES.map((name) => button(name, toggled(name))),
    ...Object.entries(TEXTS.modes).map(([mode, text]) => make("button", { "data-mode": mode, onclick: () => command("select_mode", { mode }) }, text)),
    make("p", { class: "hint" }, TEXTS.keys));
  const label = (text, ...rest) => make("label", {}, text, ...rest);
  $("overrides").replaceChildren(...["feed", "rapid", "spindle"].map((name) => label(TEXTS[name],
    make("input", { type: "range", id: `override-${name}`, min: 0, max: name === "rapid" ? 100 : 200, step: name === "rapid" ? 25 : 5, value: 100,
      onchange: (event) => command("set_overrides", { [name]: Number(event.target.value) / 100 }) }),
    make("output", { id: `override-${name}-is` }))));
  const row = (head, from) => [make("b", {}, head), ...[0, 1, 2].map((k) => make("b", { id: `figure${from + k}` }, "0"))];
  $("fst").replaceChildren(make("b", { id: "tool" }), make("i", {}, TEXTS.programmed), make("i", {}, TEXTS.commanded), make("i", {}, TEXTS.actual),
    ...row("F", 0), ...row("S", 3));
  const mdi = make("input", { class: "mdi", id: "mdi", placeholder: TEXTS.mdi, "aria-label": TEXTS.mdi, list: "history" });
  const history = make("datalist", { id: "history" });
  const enter = async () => {
    if (await command("set_mdi", { text: `${mdi.value}\n` })) { history.prepend(make("option", { value: mdi.value })); command("cycle_start"); }
  };
  mdi.addEventListener("keydown", (event) => { if (event.key === "Enter") enter(); });
  const jogs = axes.flatMap((axis) => [1, -1].map((direction) => make("button", { "data-jog": axis, "data-way": direction, onpointerdown: () => press(axis, direction),
    onpointerup: () => release(axis), onpointerleave: () => release(axis), onpointercancel: () => release(axis) }, `${axis}${direction > 0 ? "+" : "−"}`)));
  const rapidly = make("button", { id: "rapidly", "aria-pressed": "false",
    onclick: () => rapidly.setAttribute("aria-pressed", rapidly.getAttribute("aria-pressed") !== "true") }, TEXTS.rapidly);
  const size = make("select", { id: "size", "aria-label": TEXTS.increment }, ...[0.001, 0.01, 0.1, 1, 10].map((value) => make("option", {}, String(value))));
  $("hand").replaceChildren(mdi, history, button("enter", enter), ...jogs, rapidly, size);
  const names = make("select", { id: "names", "aria-label": TEXTS.programs }), text = make("textarea", { id: "text", "aria-label": TEXTS.edit, spellcheck: "false" });
  const name = make("input", { id: "new", placeholder: TEXTS.name, "aria-label": TEXTS.name });
  const edit = async () => {
    const answer = names.value && (await ask(`programs/${encodeURIComponent(names.value)}`));
    if (answer) { text.value = await answer.text(); name.value = names.value; }
  };
  const remove = () => names.value && ask(`programs/${encodeURIComponent(names.value)}`, { method: "DELETE" });
  const save = () => ask(`programs/${encodeURIComponent(name.value)}`, { method: "PUT", body: text.value });
  const programs = make("div", { id: "page-programs", role: "tabpanel", "aria-labelledby": "tab-programs" }, names, button("select", () => command("select_program", { program: names.value })), button("edit", edit), name, button("save", save), button("remove", remove), text);
  programs.addEventListener("dragover", (event) => event.preventDefault());
  programs.addEventListener("drop", async (event) => {
    event.preventDefault();
    const file = event.dataTransfer.files[0];
    if (file) { name.value = file.name.replace(/\.[^.]*$/, ""); text.value = await file.text(); }
  });
  pages = new Pages($("store"), programs, { make, ask, url, command, say, lease, parts_of_machine: state.parts });
  pages.status = state.status;
  $("path").setAttribute("aria-label", TEXTS.path);
  $("steps").replaceChildren(
    button("from_line", () => command("search", { line: state.chosen, calculate: true }).then((done) => done && say(TEXTS.searched))),
    button("breakpoint", toggleBreakpoint));
  for (const each of $("steps").children) each.disabled = true;
  $("lines").onkeydown = (event) => {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step) { event.preventDefault(); choose(state.chosen + step); }
  };
  const rate = make("select", { id: "rate", "aria-label": TEXTS.rate }, ...RATES.map((value) => make("option", { value: String(value) }, value ? `${value} ×` : TEXTS.frozen)));
  rate.onchange = () => ask("clock", { method: "POST", body: JSON.stringify({ rate: Number(rate.value) }) });
  const far = make("button", { id: "far", "aria-pressed": "false", onclick: () => far.setAttribute("aria-pressed", document.body.classList.toggle("far")) }, TEXTS.far);
  $("tools").replaceChildren(rate, far, lease.button);
}

async function begin() {
  const machines = await (await fetch("/api/machines")).json();
  $("machine").replaceChildren(...machines.map((each) => make("option", { value: each.name }, each.name)));
  state.machine = machines[0].name;
  const choose = () => { state.parts = machines.find((each) => each.name === state.machine).parts; document.body.classList.toggle("board", !state.parts.includes("control")); };
  choose();
  $("machine").onchange = (event) => { releaseAll(); pages.close(); leave(); state.machine = event.target.value; choose(); path.clear(); charts.clear(); open(); };
  await open();
}
// Nothing of a machine may be asked of, or shown for, the one that is chosen after it.
function leave() {
  const { socket } = state;
  state.socket = null;
  socket?.close();
  clearTimeout(drawPath.timer);
  state.lines = "";
}
async function open() {
  const status = await (await fetch(url("status"))).json();
  build(Object.keys(status.channels ? status.axes : {}));
  show(status);
  connect();
}
begin();
