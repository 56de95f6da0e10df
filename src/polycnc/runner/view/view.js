// The page of a view: what is where at a moment, and what one can do with it.
import { Group, Matrix4, Vector3 } from "three";
import { Chart } from "./chart.js";
import { Field } from "./field.js";
import { save, stl, threeMf } from "./files.js";
import { floor } from "./floor.js";
import { after, clockText, units } from "./format.js";
import { polyline } from "./lines.js";
import { Listing } from "./listing.js";
import { Path } from "./path.js";
import { Record } from "./record.js";
import { Solid } from "./solid.js";
import { directions, Stage } from "./stage.js";
import { begin, css, paletteColour, rgb, scaleColours, turnOver } from "./theme.js";
import { toolShape } from "./tool_shape.js";
import { Turned } from "./turned.js";

const element = (id) => document.getElementById(id);
const make = (tag, properties) => Object.assign(document.createElement(tag), properties);

export async function start(buffers) {
  const record = new Record(buffers), { about } = record, unit = units(about.inch), lathe = about.lathe;
  begin();
  const path = new Path(record);
  const stage = new Stage(element("stage"), { flat: Boolean(lathe) && !about.stock });
  stage.reach = 2 * Math.max(...path.all.flat().map(Math.abs), 1) + 100;
  const say = (text) => { element("status").textContent = text; };
  const part = new Group(), carried = new Group(); // what turns with a table, and the tool
  part.matrixAutoUpdate = carried.matrixAutoUpdate = false;
  stage.scene.add(part, carried);
  part.add(path.rapids.mesh, path.cuts.mesh);
  let mirrored = null;
  if (lathe && !about.stock) { // a full profile: the same below the axis of the spindle
    mirrored = path.cuts.mesh.clone();
    mirrored.scale.z = -1;
    part.add(mirrored);
  }
  const body = about.stock && bodyOf(record, path);
  if (body) {
    part.add(body.mesh);
    stage.before.push(() => body.seenFrom(stage.camera.position, stage.controls.target));
    path.cuts.set("width", 1.4);
    path.box = path.box.map(([low, high], i) => [Math.min(low, body.box[i][0]), i === 2 && !lathe ? Math.max(body.box[2][1], Math.min(high, body.box[2][1] + 5)) : Math.max(high, body.box[i][1])]);
  }
  const rest = path.rest(); // what could be read after an alarm
  if (rest) { rest.material.depthTest = !body; part.add(rest.mesh); path.box = path.box.map(([low, high], i) => [Math.min(low, rest.box[i][0]), Math.max(high, rest.box[i][1])]); }
  path.seen = path.box.map(([low, high], i) => [Math.min(low, path.between[i][0]), Math.max(high, path.between[i][1])]);
  let ground = null;
  const wide = [path.cuts, path.rapids, ...(rest ? [rest] : [])]; // lines that must know how large the stage is
  stage.before.push(() => { for (const each of wide) each.fit(stage); ground?.fit(stage, element("legend")); });

  // ---------------------------------------------------------------- what is drawn besides the path
  const extra = {};
  const replace = (name, places, options, colour, parent = part) => {
    if (extra[name]) { parent.remove(extra[name].mesh); wide.splice(wide.indexOf(extra[name]), 1); extra[name].geometry.dispose(); delete extra[name]; }
    if (!places || places.length < 2) return;
    const lines = extra[name] = polyline(places, options);
    lines.paint(() => rgb(colour)); lines.paper(css("--paper"));
    wide.push(lines); parent.add(lines.mesh);
  };
  const cross = (at, size) => [0, 1, 2].flatMap((i) => [-1, 1].map((side) => at.map((v, n) => v + (n === i ? side * size : 0))).concat([null]));
  function drawFloor() {
    if (ground) { part.remove(ground.group); for (const each of ground.lines) wide.splice(wide.indexOf(each), 1); }
    const names = about.tips && !lathe ? about.tips.map((i) => (i === null ? "" : record.axes[i].name)) : ["X", "Y", "Z"];
    ground = floor(path.box, names, unit, lathe);
    part.add(ground.group);
    wide.push(...ground.lines);
  }
  const longest = Math.max(...path.box.map(([low, high]) => high - low), 1);
  function drawMarks() {
    const alarms = about.remarks.filter((each) => each.kind !== "remark" && each.time_s !== null && record.points);
    replace("alarms", alarms.flatMap((each) => cross(path.place(record.at(each.time_s).tip), 0.02 * longest)), { width: 4, order: 5 }, css("--accent"));
    if (!about.other) return;
    const { points } = { points: record.other_t_s.length }, places = [];
    for (let k = 0; k < points; k++) places.push(path.place([0, 1, 2].map((i) => record.other_tip[i * points + k] - about.zero[i])));
    replace("other", places, { width: 2, order: 3 }, css("--other"));
    replace("marks", about.other.marks.flatMap((mark) => cross(path.place(mark.place.map((v, i) => v - about.zero[i])), 0.015 * longest)), { width: 3, order: 5 }, css("--accent"));
  }
  let tool = null, shownTool = -1;
  function drawTool(number) {
    shownTool = number;
    if (tool) carried.remove(tool);
    tool = toolShape(about.shapes[String(number)], 0.16 * longest, paletteColour(path.tools.indexOf(number)));
    if (lathe && about.shapes[String(number)]?.outline) tool.rotation.y = Math.PI / 2; // what rotates lies along the axis
    carried.add(tool);
  }

  // ---------------------------------------------------------------- colours
  const LOADS = { rate: "removal", axial: "cut depth", radial: "cut width", chip: "chip" }, loaded = Object.keys(record.loads);
  const loadText = (name, value) => (name === "rate" ? unit.rate(value) : unit.length(value));
  loaded.forEach((name) => element("colour").add(new Option(LOADS[name], name)));
  const chip = (colour, text, name = "") => {
    const mark = make("i", { className: name }), entry = make("div", {});
    if (colour) mark.style.background = colour;
    entry.append(mark, text);
    return entry;
  };
  function drawLegend() {
    const legend = element("legend"), how = element("colour").value;
    legend.replaceChildren();
    if (["speed", "depth", "power"].includes(how) || record.loads[how]) {
      const bar = make("div", { className: "scale" }), ends = make("div", { className: "ends" }), [low, high] = path.depths;
      bar.style.background = `linear-gradient(to right, ${scaleColours().join(",")})`;
      const texts = record.loads[how] ? ["0", loadText(how, record.loads[how].top)] : how === "power" ? ["0", `S${+path.topPower.toFixed(1)}`] : how === "speed" ? ["0", `${path.usualFeed < 0.99 * path.topFeed ? "≥ " : ""}${unit.feed(path.usualFeed)}`] : [unit.length(low), unit.length(high)];
      ends.append(...texts.map((textContent) => make("span", { textContent })));
      legend.append(bar, ends);
    } else if (how === "tool") path.tools.forEach((number, i) => legend.append(chip(paletteColour(i), `T${number}`)));
    else if (how === "operation") about.operations.forEach((each, i) => legend.append(chip(paletteColour(i), (each.name || `T${each.tool}`).slice(0, 60))));
    else {
      const used = new Set(path.cuts.which.map((k) => record.block_kind[record.number[record.blockAt[k]]]));
      about.kinds.forEach((kind, i) => { if (used.has(i)) legend.append(chip(paletteColour(i), kind)); });
    }
    if (path.rapids.count) legend.append(chip("", "rapid", "rapid"));
    if (rest) legend.append(chip(css("--rest"), "not run, after the alarm"));
    if (about.other) legend.append(chip(paletteColour(0), about.other.own), chip(css("--other"), about.other.name));
  }
  function recolour() {
    const how = element("colour").value;
    path.paint(how);
    rest?.paint(() => rgb(css("--rest"))); rest?.paper(css("--paper"));
    if (body) body.paint(path.colouringAt(how));
    drawLegend(); stage.draw();
  }
  function drawBody() { // as cut, or before, after, off; and the section
    const how = element("stock").value, across = element("section").value, axis = across === "" ? null : Number(across);
    body.mesh.visible = how !== "off";
    body.goTo(how === "whole" ? -1 : how === "finished" ? Infinity : now);
    if (record.executions) { const execution = record.executionAt(now); body.light(record.start_s[execution], record.endOf(execution)); }
    element("cut").hidden = axis === null;
    const [low, high] = body.box[axis ?? 0], share = Number(element("cut").value);
    body.cutAt(axis, axis === 1 ? low + share * (high - low) : high - share * (high - low));
    path.cuts.mesh.visible = path.rapids.mesh.visible = axis === null && how !== "finished";
    stage.draw();
  }

  // ---------------------------------------------------------------- the chart
  const linearAxes = record.axes.map((axis, i) => ({ ...axis, i }));
  const charts = [{ name: "path speed", unit: `${unit.name}/min`, y: () => record.feed.map((f) => f * unit.factor), top: path.topRapid > 2 * path.topFeed && path.cuts.count ? 1.15 * path.topFeed * unit.factor : null, zero: true }];
  for (const { name, i, unit: of } of linearAxes) charts.push({ name: `position ${name}`, unit: of === "deg" ? "°" : unit.name, y: () => record.position.slice(i * record.points, (i + 1) * record.points).map((v) => (of === "deg" ? v : v * unit.factor)) });
  if (record.motion_low) about.derivatives.forEach((what, d) => { for (const { name, i, unit: of } of linearAxes) charts.push({ name: `${what} ${name}`, unit: `${of === "deg" ? "°" : "mm"}/s${["", "²", "³"][d]}`, motion: d * record.axes.length + i }); });
  for (const name of loaded) charts.push({ name: LOADS[name], unit: name === "rate" ? (about.inch ? "in³/min" : "cm³/min") : unit.name, load: record.loads[name] });
  const chart = new Chart(element("chart"), {
    onTime: (t) => goTo(t),
    colours: () => ({ line: paletteColour(0), band: `${paletteColour(0)}44`, soft: css("--soft"), grid: css("--line"), now: css("--accent") }),
  });
  function drawChart() {
    const each = charts[element("shown").value];
    if (each.load) {
      const { values, stretch_s } = each.load, factor = each.load === record.loads.rate ? 60 * (about.inch ? 25.4 ** -3 : 1e-3) : unit.factor;
      chart.show({ x: Array.from(values, (_, n) => (n + 0.5) * stretch_s), y: Array.from(values, (value) => value * factor), end: record.end_s || 1, unit: each.unit, zero: true });
    } else if (each.motion === undefined) chart.show({ x: record.t_s, y: each.y(), end: record.end_s || 1, unit: each.unit, top: each.top ?? null, zero: each.zero });
    else {
      const n = record.motion_low.length / (about.derivatives.length * record.axes.length), x = [], y = [];
      for (let k = 0; k < n; k++) for (const side of [record.motion_low, record.motion_high]) { x.push(Math.min((k + (side === record.motion_low ? 0.25 : 0.75)) * about.stretch_s, record.end_s)); y.push(side[each.motion * n + k]); }
      chart.show({ x, y, end: record.end_s || 1, unit: each.unit });
    }
    element("chart").drawn = chart;
  }

  // ---------------------------------------------------------------- the moment that is shown
  let now = 0, playing = false, before_ms = 0, shownExecution = -1, kind = "work";
  const listing = new Listing(element("listing"), element("rows"), {
    texts: about.text, lines: record.line, remarks: new Map(about.remarks.map((each) => [each.row, each]).reverse()),
    onRow: (row) => { say(""); goToRow(row); },
  });
  const cells = {};
  for (const name of ["time", "speed", "tool", "line", ...record.axes.map((axis) => axis.name), ...(lathe ? ["⌀"] : []), ...loaded.map((each) => LOADS[each])]) {
    const cell = make("dd", {});
    cell.dataset.of = name;
    element("readout").append(make("dt", { textContent: name }), cell);
    cells[name] = cell;
  }
  function readout(here, execution) {
    const zero = record.zeroAt(now), to = kind === "to go" ? record.at(record.endOf(execution)).axes : null;
    record.axes.forEach((axis, i) => {
      const value = to ? to[i] - here.axes[i] : kind === "work" ? here.axes[i] - zero[i] : here.axes[i], text = Math.abs(value) < 5e-7 ? 0 : value;
      cells[axis.name].textContent = axis.unit === "deg" ? `${text.toFixed(3)} °` : unit.length(text);
    });
    if (lathe) { const x = record.axes.findIndex((axis) => axis.name === "X"); cells["⌀"].textContent = unit.length(2 * (here.axes[x] - zero[x])); }
  }
  function goTo(t) {
    now = Math.min(Math.max(t, 0), record.end_s);
    element("slider").value = now;
    element("slider").setAttribute("aria-valuetext", `${now.toFixed(3)} seconds`);
    element("clock").textContent = `${clockText(now)} / ${clockText(record.end_s)}`;
    cells.time.textContent = `${now.toFixed(3)} s`;
    if (!record.points) return;
    const here = record.at(now), execution = record.executionAt(now), number = record.toolOf(execution), row = record.rowOf(execution);
    readout(here, execution);
    for (const name of loaded) { const value = record.loads[name].at(now - 1e-6); cells[LOADS[name]].textContent = value > 0 ? loadText(name, value) : "–"; }
    cells.speed.textContent = unit.feed(here.feed);
    cells.tool.textContent = record.executions ? `T${number}` : "";
    cells.line.textContent = row >= 0 ? record.line[row] : "";
    if (row !== listing.lit) listing.light(row);
    if (number !== shownTool) drawTool(number);
    if (execution !== shownExecution) {
      shownExecution = execution;
      if (record.executions) {
        const places = path.pointsOf(execution);
        replace("block", places, { width: 6, order: 4 }, css("--accent"));
        const ends = places.length < 60 ? places : [places[0], places[places.length - 1]];
        replace("points", ends.flatMap((at) => cross(at, 0.006 * longest)), { width: 2, order: 5 }, css("--ink"));
      }
    }
    place(here);
    if (body) drawBody();
    const faint = body?.mesh.visible ? 0 : now <= 0 ? 1 : 0.28; // of what is still to come
    for (const each of [path.cuts, path.rapids]) { each.set("now", now); each.set("faint", faint); }
    chart.now(now);
    stage.draw();
  }
  function place(here) { // part and tool, as the machine has turned them or as the part sees it
    const at = new Vector3(...path.place(here.tip)), turned = record.turned(here.axes), machine = element("frame").value === "machine";
    const back = turned.part.clone().invert();
    part.matrix.copy(machine ? turned.part : new Matrix4());
    carried.matrix.copy(machine ? turned.tool : back.multiply(turned.tool)).setPosition(machine ? at.clone().applyMatrix4(turned.part) : at);
    part.matrixWorldNeedsUpdate = carried.matrixWorldNeedsUpdate = true;
    element("stage").dataset.tip = at.toArray().join(" ");
    if (about.other && record.other_t_s.length) replace("beside", cross(path.place(record.otherAt(now)), 0.02 * longest), { width: 4, order: 6 }, css("--other"));
  }
  function goToRow(row) { // its next execution after this moment, or else its first
    const here = record.executionAt(now);
    for (let step = 1; step <= record.executions; step++) {
      const execution = (here + step) % record.executions;
      if (record.rowOf(execution) === row) { goToExecution(execution); return; }
    }
    say(`Line ${record.line[row]} takes no time.`);
  }
  function goToExecution(execution) {
    if (record.executions) goTo(record.start_s[Math.min(Math.max(execution, 0), record.executions - 1)] + 2e-6);
  }
  function play(on) {
    playing = on && record.end_s > 0;
    element("play").textContent = playing ? "❚❚" : "▶";
    element("play").setAttribute("aria-label", playing ? "Stop" : "Play");
    if (!playing) return;
    if (now >= record.end_s) now = 0;
    before_ms = performance.now();
    requestAnimationFrame(tick);
  }
  function tick(at_ms) {
    if (!playing) return;
    goTo(now + Math.max(at_ms - before_ms, 0) / 1000 * Number(element("rate").value));
    before_ms = at_ms;
    if (now >= record.end_s) play(false); else requestAnimationFrame(tick);
  }

  // ---------------------------------------------------------------- measuring: ends and middles of blocks and centres of arcs attract
  let measured = null;
  function snapped(hit, x, y) { // `hit` on the path or on the body, null beside both
    const wanted = [...path.centres()];
    if (hit?.k !== undefined) {
      const execution = record.blockAt[hit.k], [from, to] = [record.start_s[execution], record.endOf(execution)].map((t) => path.place(record.at(t).tip));
      const straight = about.kinds[record.block_kind[record.number[execution]]] === "line";
      wanted.unshift(from, to, ...(straight ? [from.map((v, i) => (v + to[i]) / 2)] : []));
    }
    const far = wanted.map((at) => { const seen = stage.project(new Vector3(...at).applyMatrix4(part.matrix)); return Math.hypot(seen.x - x, seen.y - y); });
    const least = far.reduce((low, each) => Math.min(low, each), Infinity);
    return least < 18 ? wanted[far.indexOf(least)] : hit?.place ?? null;
  }
  function onBody(x, y) { // what of the body is at a pixel
    if (!body?.mesh.visible) return null;
    const back = part.matrix.clone().invert(), ends = [-1, 1].map((depth) => new Vector3(2 * x / stage.width - 1, 1 - 2 * y / stage.height, depth).unproject(stage.camera).applyMatrix4(back).toArray());
    return body.pick(...ends);
  }
  let pointed = null; // the cut of the block under the pointer lights up
  function point(x, y) {
    const found = onBody(x, y), execution = found && found.t !== null ? record.executionAt(found.t) : null;
    if (execution === pointed) return;
    pointed = execution;
    const of = execution ?? record.executionAt(now), row = record.rowOf(of);
    body.light(record.start_s[of], record.endOf(of));
    element("tip").hidden = execution === null || row < 0;
    if (execution !== null && row >= 0) element("tip").textContent = `${record.line[row]}  ${about.text[row]}`.slice(0, 60);
    element("tip").style.setProperty("left", `${Math.min(x + 14, stage.width - 180)}px`);
    element("tip").style.setProperty("top", `${y + 14}px`);
    stage.draw();
  }
  function measure(at) {
    measured.push(at);
    if (measured.length < 2) { say("Now the other place."); return; }
    const [from, to] = measured, off = from.map((v, i) => to[i] - v), [x, y, z] = lathe ? [off[2], null, off[0]] : off;
    const parts = [["X", x], ["Y", y], ["Z", z]].flatMap(([name, d]) => (d === null ? [] : [`${name} ${unit.number(d)}`]));
    say(`Distance ${unit.length(Math.hypot(...off))} (${parts.join(", ")})`);
    replace("ruler", [from, to], { width: 3, order: 6 }, css("--ink"));
    measured = [];
    stage.draw();
  }
  function toggleMeasure() {
    measured = measured ? null : [];
    element("measure").setAttribute("aria-pressed", String(Boolean(measured)));
    say(measured ? "Click two places: ends, middles and centres of arcs attract." : "");
    if (!measured) { replace("ruler", null); stage.draw(); }
  }
  let pressed = null;
  stage.canvas.addEventListener("pointerdown", (event) => { pressed = [event.clientX, event.clientY]; });
  stage.canvas.addEventListener("pointerup", (event) => {
    if (!pressed || Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 5) return;
    const box = stage.canvas.getBoundingClientRect(), [x, y] = [event.clientX - box.left, event.clientY - box.top];
    const hit = path.pick(stage, x, y, part.matrix) ?? onBody(x, y);
    if (measured) { const at = snapped(hit, x, y); if (at) measure(at); } else if (hit && hit.t !== null) goTo(hit.t);
  });
  if (body) stage.canvas.addEventListener("pointermove", (event) => {
    if (event.buttons || playing || !record.executions) return;
    const box = stage.canvas.getBoundingClientRect();
    point(event.clientX - box.left, event.clientY - box.top);
  });

  // ---------------------------------------------------------------- what is around it
  element("title").textContent = about.program.split(/[\\/]/).pop();
  element("title").title = about.program;
  element("summary").textContent = element("summary").title = [about.machine, about.summary, unit.size(about.path_mm), about.ok ? "" : "stopped by an alarm", about.other ? `beside ${about.other.name}` : ""].filter(Boolean).join(" · ");
  const stopped = about.remarks.find((each) => each.kind === "alarm");
  if (stopped) {
    const here = record.points ? record.at(record.end_s).axes : [], zero = record.points ? record.zeroAt(record.end_s) : [];
    const place = record.axes.slice(0, here.length).map((axis, i) => `${axis.name}${axis.unit === "deg" ? (here[i] - zero[i]).toFixed(3) : unit.number(here[i] - zero[i])}`).join(" ");
    element("stopped").textContent = `▲ Stopped${stopped.line ? ` at line ${stopped.line}` : ""}${place ? `, ${place}` : ""}: ${stopped.text}`;
    element("stopped").hidden = false;
    element("stopped").onclick = () => { goTo(record.end_s); if (stopped.row >= 0) listing.light(stopped.row); };
  }
  element("note").textContent = about.note;
  element("slider").max = record.end_s;
  for (const rate of [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000]) element("rate").add(new Option(`${rate}×`, rate, rate === 10, rate === 10));
  charts.forEach((each, i) => element("shown").add(new Option(each.name, i)));
  const shownViews = lathe ? ["Front", "3-D"] : directions;
  const look = (name) => stage.look(name, lathe ? ground.box : body?.mesh.visible ? path.box : path.seen, lathe ? 0.97 : 0.8);
  shownViews.forEach((name) => element("views").append(make("button", { type: "button", textContent: lathe && name === "Front" ? "Profile" : name, onclick: () => look(name) })));
  element("views").append(make("button", { type: "button", textContent: "All", title: "Everything, rapids too", onclick: () => stage.look(shownViews[0], path.all) }));
  for (const name of ["work", "machine", "to go"]) element("places").append(make("button", { type: "button", textContent: name, onclick: () => choose(name) }));
  function choose(name) {
    kind = name;
    for (const each of element("places").children) each.setAttribute("aria-pressed", String(each.textContent === name));
    if (record.points) readout(record.at(now), record.executionAt(now));
  }
  function drawTables() {
    const body = element("tools").tBodies[0], jobs = element("operations").tBodies[0];
    body.replaceChildren(); jobs.replaceChildren();
    about.tools.forEach((each) => {
      const row = body.insertRow(), share = (each.cutting_s + each.rapid_s) / Math.max(about.time_s, 1e-9);
      row.insertCell().append(chip(paletteColour(path.tools.indexOf(each.tool)), `T${each.tool}`));
      for (const text of [clockText(each.cutting_s), clockText(each.rapid_s), `${(100 * share).toFixed(1)} %`]) row.insertCell().textContent = text;
    });
    element("tools").hidden = !about.tools.length;
    about.operations.forEach((each) => {
      const row = jobs.insertRow();
      row.insertCell().append(make("button", { type: "button", textContent: each.name || `T${each.tool}`, onclick: () => goTo(each.start_s + 2e-6) }));
      for (const time of [each.cutting_s, each.time_s]) row.insertCell().textContent = clockText(time);
    });
    element("operations").hidden = about.operations.length < 2;
  }
  const list = (button) => element("remarks").appendChild(make("li", {})).append(button);
  const signs = { alarm: "▲ alarm", collision: "▲ collision", remark: "● remark" };
  for (const each of about.remarks) {
    list(make("button", {
      type: "button", className: each.kind, textContent: `${signs[each.kind]}${each.line ? `, line ${each.line}` : ""}: ${each.text}${each.hint ? `. ${each.hint}` : ""}`,
      onclick: () => { if (each.time_s !== null) goTo(each.time_s); else if (each.row >= 0) goToRow(each.row); if (each.row >= 0) listing.light(each.row); },
    }));
  }
  for (const mark of about.other?.marks ?? []) list(make("button", { type: "button", textContent: `◇ ${mark.text}`, onclick: () => { if (mark.time_s !== null) goTo(mark.time_s); } }));
  if (!record.points) say("The program moves no axis.");
  element("stocks").hidden = element("sections").hidden = !body;
  if (lathe) ["none", "across", "along"].forEach((name, i) => { element("section").options[i].text = name; });
  if (body && !body.changes) element("stock").value = "off"; // no tool is known: the path says more
  for (const each of element("save").options) each.hidden = each.disabled = !body && ["stl", "3mf"].includes(each.value);
  element("save").onchange = async () => { // the picture, or the body, as it is shown
    const how = element("save").value, name = `${element("title").textContent.replace(/\.[^.]*$/, "") || "part"}.${how}`;
    element("save").value = "";
    if (how === "png") { stage.render(); stage.canvas.toBlob((blob) => save(blob, name)); }
    else if (how) save(await { stl, "3mf": threeMf }[how](body.surface()), name);
    if (how) say(`${name}${how === "png" ? "" : ", mm from program zero"}`);
  };
  element("stock").oninput = () => goTo(now);
  for (const id of ["section", "cut"]) element(id).oninput = () => drawBody();
  element("frames").hidden = !about.chain.length;
  element("frame").onchange = () => goTo(now);
  element("slider").oninput = () => goTo(Number(element("slider").value));
  element("play").onclick = () => play(!playing);
  if (record.power) { element("colour").prepend(make("option", { value: "power", textContent: "power" })); element("colour").value = "power"; }
  else element("colour").value = path.telling(Boolean(body && body.changes));
  element("colour").onchange = recolour;
  element("shown").onchange = () => { drawChart(); chart.now(now); };
  element("measure").onclick = toggleMeasure;
  element("theme").onclick = () => { turnOver(); draw(); };
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const on = event.target.tagName;
    if (on === "SELECT" || ((on === "BUTTON" || on === "SUMMARY") && [" ", "Enter"].includes(event.key))) return;
    const faster = (by) => { const rate = element("rate"); rate.selectedIndex = Math.min(Math.max(rate.selectedIndex + by, 0), rate.options.length - 1); };
    const kinds = ["work", "machine", "to go"], colour = element("colour");
    const actions = {
      " ": () => play(!playing), ArrowLeft: () => goToExecution(record.executionAt(now) - 1), ArrowRight: () => goToExecution(record.executionAt(now) + 1),
      PageUp: () => goToExecution(record.executionAt(now) - 10), PageDown: () => goToExecution(record.executionAt(now) + 10),
      Home: () => goTo(0), End: () => goTo(record.end_s), "+": () => faster(1), "-": () => faster(-1),
      c: () => { colour.selectedIndex = (colour.selectedIndex + 1) % colour.options.length; recolour(); },
      w: () => choose(kinds[(kinds.indexOf(kind) + 1) % 3]), m: toggleMeasure,
    };
    shownViews.forEach((name, i) => { actions[i + 1] = () => look(name); });
    const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (action) { event.preventDefault(); action(); }
  });

  function draw() {
    stage.paper(css("--paper"));
    drawTables(); recolour(); drawFloor(); drawMarks(); drawChart(); choose(kind);
    shownExecution = shownTool = -1; listing.lit = -2;
    goTo(now);
  }
  if (body && body.changes) now = record.end_s; // the part first: what has been cut
  draw();
  look(shownViews[0]);
  element("stage").seen = { path, stage, part, body };
  document.documentElement.dataset.ready = "yes";
}

const BODIES = { field: Field, turned: Turned, solid: Solid };

function bodyOf(record, path) {
  const { stock, zero } = record.about;
  return new BODIES[stock.kind]({
    ...stock, place: path.place(stock.first.map((first, i) => first - zero[i])),
    begin: record.stock_begin, ends: record.stock_s, counts: record.stock_counts, jumps: record.stock_cells, levels: record.stock_levels,
  });
}
