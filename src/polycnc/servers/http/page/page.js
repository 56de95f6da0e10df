// The operator's page: what the stream of a machine sends is shown, and keys ask the commands of REST.
import { $, button, isPressed, kept, make, put, toggle } from "/dom.js";
import { TEXTS } from "/texts.js";
import { Charts } from "/charts.js";
import { Link } from "/link.js";
import { channelChoice, Marks, Switches } from "/choices.js";
import { Manual } from "/manual.js";
import { Mdi } from "/mdi.js";
import { Path } from "/path.js";
import { OVER, Program } from "/program.js";
import { Tabs } from "/tabs.js";
import { Words } from "/words.js";
import { follow, shortcutList } from "/shortcuts.js";
import { THEMES, theme, wear } from "/theme.js";
import "/axes.js";

const RATES = [0, 0.1, 0.5, 1, 2, 5, 10, 50], REDRAW_MS = 300, AGAIN_MS = 1000, MOST_JUMP = 60_000;

const link = new Link(), channels = channelChoice(link, (number) => choose(shown, number)), path = new Path($("path"), $("views")), charts = new Charts($("charts")), axes = document.querySelector("cnc-axes"), runPage = $("page-run"), main = document.querySelector("main");
let choices = 0, drawings = 0;
let parts = null, shown = null; // the machine that is looked at, and what is built for it

// ---------------------------------------------------------------- what is shown

link.addEventListener("message", ({ detail }) => {
  document.body.classList.remove("lost");
  put($("connection"), TEXTS.connected);
  if (!detail.isLate && document.activeElement !== $("rate")) $("rate").value = String(detail.rate);
  for (const id of ["one_cycle", "next_event"]) $(id).hidden = detail.rate !== 0;
  if (!detail.isLate) link.lease.show(detail.lease);
  parts.tabs.inventory(detail.inventory);
  const { breakpoints, tools, offsets, programs } = detail.inventory;
  if (breakpoints) parts.program.setBreakpoints(breakpoints, detail.number);
  if (programs) parts.program.setPrograms(programs);
  else if (tools || offsets) drawPath(parts.program.name);
});

link.addEventListener("lost", () => {
  document.body.classList.add("lost");
  put($("connection"), TEXTS.lost);
  parts?.manual.releaseAll();
});

link.addEventListener("status", ({ detail: status }) => {
  if (main.inert) { showStop(status.emergency === "on"); return; } // nothing is built for this machine yet
  const channel = status.channels?.[link.channel];
  put($("clock"), `${status.time_s.toFixed(1)} s`);
  if (!channel) { axes.showBoard(status); return; }
  put($("mode"), TEXTS.modes[channel.mode] ?? channel.mode);
  channels.show(status);
  $("run").dataset.state = channel.run_state;
  put($("run"), channel.run_state.replaceAll("_", " "));
  axes.show(status.axes, channel.axes);
  path.at(ownAxes(status), channel.block?.program === parts.program.name ? channel.block.line : 0, !OVER.includes(channel.run_state));
  charts.add(status, channel.feed);
  notices("alarms", status.alarms);
  notices("messages", status.messages);
  parts.words.show(status, channel);
  parts.manual.show(channel.mode);
  parts.program.show(status, channel);
  put($("far-line"), [`F ${channel.feed.actual.toFixed(0)}`, `S ${status.spindle.actual_rpm.toFixed(0)}`, `T${channel.tool.number}`, channel.program ?? "", $("progress").textContent].filter(Boolean).join("  ·  "));
  showKeys(channel, status.emergency === "on");
});

// The axes of the channel that is shown.
const ownAxes = (status) => Object.fromEntries((status.channels?.[link.channel].axes ?? []).map((name) => [name, status.axes[name]]));

function notices(id, all) {
  const told = JSON.stringify(all), place = $(id);
  if (place.dataset.told === told) return;
  place.dataset.told = told;
  place.replaceChildren(...all.map((each) => make("p", {}, each.number < 0 ? each.text : `${each.number} ${each.text}`, make("span", {}, TEXTS.cleared[each.cleared_by] ?? ""))));
}

function showKeys(channel, pressed) {
  for (const key of document.querySelectorAll("[data-mode]")) key.setAttribute("aria-pressed", key.dataset.mode === channel.mode);
  parts.switches.show(channel.switches);
  parts.marks.show(channel.switches.block_delete);
  showStop(pressed);
}

function showStop(pressed) {
  $("stop").setAttribute("aria-pressed", pressed);
  put($("stop"), pressed ? TEXTS.release : TEXTS.stop);
}

// Where the program goes, asked anew when it, a tool or an offset has changed.
function drawPath(name) {
  const turn = ++drawings;
  clearTimeout(drawPath.timer);
  if (!name || !link.has("path")) { path.show(null); return; }
  drawPath.timer = setTimeout(async () => {
    const answer = await fetch(link.url(`path?program=${encodeURIComponent(name)}`)).catch(() => null), told = await answer?.json().catch(() => null);
    if (turn !== drawings || parts.program.selected !== name || !told) return;
    path.show(answer.ok ? told : null, answer.ok ? told.errors[0] ?? "" : told.detail);
  }, REDRAW_MS);
}

// ---------------------------------------------------------------- keys

addEventListener("keydown", (event) => { if (!follow(event) && !main.inert) parts?.manual.keyDown(event); });
addEventListener("keyup", (event) => parts?.manual.keyUp(event));
addEventListener("blur", () => parts?.manual.releaseAll());
addEventListener("pagehide", () => parts?.manual.releaseAll());
document.addEventListener("visibilitychange", () => { if (document.hidden) parts?.manual.releaseAll(); });

function buildKeys() {
  const marks = new Marks(link), switches = new Switches(link), key = (name) => button(name, TEXTS[name], () => link.command(name));
  const group = (name, ...inside) => make("div", { role: "group", "aria-label": TEXTS[name], class: "row" }, ...inside);
  $("keys").replaceChildren(
    group("key_group", ...["cycle_start", "feed_hold", "reset"].map(key)),
    group("mode_group", ...Object.entries(TEXTS.modes).map(([mode, text]) => make("button", { "data-mode": mode, "aria-pressed": "false", onclick: () => link.command("select_mode", { mode }) }, text))),
    group("switch_group", ...switches.elements, ...marks.elements));
  return { marks, switches };
}

function build() {
  const names = Object.keys(ownAxes(link.status)), keys = buildKeys();
  new Mdi(link, $("mdi_line"));
  parts = { ...keys, of: shown, words: new Words(link), manual: new Manual(link, $("hand"), names), program: new Program(link, () => drawPath(parts.program.selected)), tabs: new Tabs(link, $("store"), runPage) };
}

// ---------------------------------------------------------------- what is there from the beginning

function buildTools(machines) {
  const option = (value, text) => make("option", { value }, text);
  const machine = make("select", { id: "machine", "aria-label": TEXTS.machine_choice, onchange: () => choose(machines.find((each) => each.name === machine.value)) }, ...machines.map(({ name }) => option(name, name)));
  const clock = (asked) => link.ask("clock", { method: "POST", body: JSON.stringify(asked) });
  const rate = make("select", { id: "rate", "aria-label": TEXTS.rate, title: TEXTS.rate, onchange: () => clock({ rate: Number(rate.value) }) }, ...RATES.map((value) => option(String(value), value ? `${value} ×` : TEXTS.frozen)));
  const colours = make("select", { id: "theme", "aria-label": TEXTS.theme, title: TEXTS.theme, onchange: () => wear(colours.value) }, ...THEMES.map((name) => option(name, TEXTS.themes[name])));
  const list = shortcutList();
  document.body.append(list);
  $("tools").replaceChildren(machine, channels.select, rate, button("one_cycle", TEXTS.one_cycle, () => clock({ step: 1 })), button("next_event", TEXTS.next_event, () => clock({ jump: MOST_JUMP })),
    toggle("far", TEXTS.far, (on) => { document.body.classList.toggle("far", on); kept.set("far", on); }), button("help", TEXTS.help, () => (list.open ? list.close() : list.show())), colours, link.lease.button);
  const header = document.querySelector("header"); // what is sticky of it on a small screen begins after the tools
  new ResizeObserver(() => header.style.setProperty("--tools", `${$("tools").offsetHeight}px`)).observe($("tools"));
  put($("stop"), TEXTS.stop);
  $("stop").onclick = () => link.command("emergency_stop", { on: !isPressed($("stop")) });
  $("path").setAttribute("aria-label", TEXTS.path);
  $("lines").setAttribute("aria-label", TEXTS.edit_text);
  colours.value = theme();
  wear(theme());
  if (kept.get("far", false)) $("far").click();
}

async function choose(machine, channel = 0) {
  const turn = ++choices, isLooked = () => turn === choices, tab = parts?.of === machine ? parts.tabs.shown : null;
  if (link.name && link.lease.mine && machine !== shown) link.lease.release();
  shown = machine;
  parts?.manual.releaseAll();
  parts?.tabs.close();
  parts?.program.close();
  main.inert = true; // what is still shown is of the machine before
  showStop(false); // whoever presses it now presses that of this machine
  link.leave();
  clearTimeout(drawPath.timer);
  drawings++;
  Object.assign(link, { status: null, name: machine.name, channel, parts: machine.parts, kind: machine.kind });
  document.body.classList.toggle("board", !link.has("control"));
  path.clear();
  charts.clear();
  const status = await link.json("status");
  if (!isLooked()) return; // another one has been chosen meanwhile
  link.status = status;
  if (!status) { setTimeout(() => { if (isLooked()) choose(machine, channel); }, AGAIN_MS); return; }
  build();
  if (tab) parts.tabs.open(tab);
  main.inert = false;
  link.tell("status", status);
  link.connect();
}

const machines = await (await fetch("/api/machines")).json();
buildTools(machines);
await choose(machines[0]);
