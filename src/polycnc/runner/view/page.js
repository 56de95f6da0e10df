"use strict";
(async () => {
  // ---------------------------------------------------------------- data
  const element = (id) => document.getElementById(id);
  const unpacked = async (id) => {
    const bytes = Uint8Array.from(atob(element(id).textContent.trim()), (c) => c.charCodeAt(0));
    element(id).textContent = "";
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
  };
  if (typeof DecompressionStream === "undefined") {
    element("summary").textContent = "This page needs a browser of 2023 or later.";
    return;
  }
  const about = JSON.parse(new TextDecoder().decode(await unpacked("about")));
  const blob = await unpacked("data");
  const arrays = { f8: Float64Array, f4: Float32Array, i4: Int32Array, u1: Uint8Array };
  const data = {};
  for (const [name, at] of Object.entries(about.columns)) data[name] = new arrays[at.type](blob, at.at, at.length);

  const points = data.t_s.length;
  const other = about.other && { ...about.other, points: data.other_t_s.length, position: (k, axis) => data.other_position[axis * data.other_t_s.length + k] };
  const executions = data.start_s.length;
  const end_s = points ? data.t_s[points - 1] : 0;
  const position = (point, axis) => data.position[axis * points + point];
  const after = (sorted, value) => { // how many are not above value
    let low = 0, high = sorted.length;
    while (low < high) { const mid = (low + high) >> 1; if (sorted[mid] <= value) low = mid + 1; else high = mid; }
    return low;
  };
  const executionAt = (t) => Math.max(after(data.start_s, t - 1e-6) - 1, 0);
  const rowOf = (execution) => (executions ? data.block_row[data.number[execution]] : -1);
  const where = (t) => { // the positions of all axes and the speed at a moment
    const next = Math.min(Math.max(after(data.t_s, t), 1), points - 1), last = Math.max(next - 1, 0);
    const span = data.t_s[next] - data.t_s[last];
    const share = span > 0 ? Math.min(Math.max((t - data.t_s[last]) / span, 0), 1) : 0;
    const between = (a, b) => a + (b - a) * share;
    return { next, axes: about.axes.map((_, i) => between(position(last, i), position(next, i))), feed: between(data.feed[last], data.feed[next]) };
  };

  // ---------------------------------------------------------------- which axes are x, y and z of the picture
  const hasPart = about.axes.some((axis) => axis.part);
  const inPart = hasPart && window.name === "polycnc part"; // kept while the page is loaded again
  const linear = about.axes.flatMap((axis, i) => (axis.unit === "mm" && Boolean(axis.part) === inPart ? [i] : []));
  const drawn = linear.length ? linear : about.axes.map((_, i) => i);
  const lathe = linear.length === 2 && linear.map((i) => about.axes[i].name).join("") === "XZ";
  const [ix, iy, iz] = lathe ? [linear[1], undefined, linear[0]] : drawn;
  const coordinate = (values, i) => (i === undefined ? 0 : values(i));
  const label = (i) => (i === undefined ? "" : `${about.axes[i].name} [${about.axes[i].unit}]`);
  const ranges = [ix, iy, iz].map((i) => {
    let low = i === undefined ? 0 : Infinity, high = i === undefined ? 0 : -Infinity;
    const widen = (v) => { if (v < low) low = v; if (v > high) high = v; };
    if (i !== undefined) for (let k = 0; k < points; k++) widen(position(k, i));
    if (i !== undefined && other) for (let k = 0; k < other.points; k++) widen(other.position(k, i));
    if (lathe && i === iz) low = Math.min(low, 0);
    return low <= high ? [low, high] : [0, 0];
  });
  const longest = Math.max(...ranges.map(([low, high]) => high - low), 1e-3);
  for (const range of ranges) {
    const room = Math.max(0.04 * longest, 0.5 * (0.1 * longest - (range[1] - range[0])));
    range[0] -= room; range[1] += room;
  }
  if (lathe) { ranges[1][0] = -0.25 * longest; ranges[1][1] = 0.25 * longest; }
  const sides = ranges.map(([low, high]) => high - low);

  // ---------------------------------------------------------------- the path, rapids apart from the rest
  const stretch = (k) => Math.hypot(...[ix, iy, iz].map((i) => (i === undefined ? 0 : position(k, i) - position(k - 1, i))));
  let whole = 0;
  for (let k = 1; k < points; k++) whole += stretch(k);
  const step = Math.max(longest / 200, whole / 50000); // long lines get points between, for clicks
  const lineOf = (rapid) => {
    const line = { x: [], y: [], z: [], point: [], time: [] };
    const push = (values, k, t) => {
      [ix, iy, iz].forEach((i, n) => line["xyz"[n]].push(values && coordinate(values, i)));
      line.point.push(k); line.time.push(t);
    };
    const at = (k, colour) => push((axis) => position(k, axis), colour, data.t_s[k]);
    const between = (k, share) => push(
      (axis) => position(k - 1, axis) + share * (position(k, axis) - position(k - 1, axis)), k, data.t_s[k - 1] + share * (data.t_s[k] - data.t_s[k - 1]));
    for (let k = 1; k < points; k++) {
      if (Boolean(data.rapid[k]) !== rapid) continue;
      if (k === 1 || Boolean(data.rapid[k - 1]) !== rapid) { if (line.x.length) push(null, k, data.t_s[k]); at(k - 1, k); }
      const parts = Math.ceil(stretch(k) / step);
      for (let part = 1; part < parts; part++) between(k, part / parts);
      at(k, k);
    }
    return line;
  };
  const cuts = lineOf(false), rapids = lineOf(true);
  const numberAt = new Int32Array(points); // the block of each point
  for (let k = 0, e = 0; k < points && executions; k++) {
    while (e + 1 < executions && data.start_s[e + 1] < data.t_s[k] - 1e-6) e++;
    numberAt[k] = data.number[e];
  }
  const tools = [...new Set([...about.tools.map((each) => each.tool), ...data.block_tool])].sort((a, b) => a - b);
  const topFeed = cuts.point.reduce((top, k) => Math.max(top, data.feed[k]), 1e-9);
  const topRapid = rapids.point.reduce((top, k) => Math.max(top, data.feed[k]), 0);
  const usualFeed = (() => { // 98 % of the cutting time is at most so fast: few fast moves leave the colours to the rest
    const speeds = new Float64Array(1001);
    for (let k = 1; k < points; k++) if (!data.rapid[k]) speeds[Math.min(Math.ceil(1000 * data.feed[k] / topFeed), 1000)] += data.t_s[k] - data.t_s[k - 1];
    const all = speeds.reduce((sum, s) => sum + s, 0);
    let i = 0;
    for (let sum = speeds[0]; i < 1000 && sum < 0.98 * all; sum += speeds[i]) i++;
    return Math.max(i, 1) * topFeed / 1000;
  })();

  // ---------------------------------------------------------------- colours
  const PALETTE = { // told apart without red and green; after Okabe and Ito
    light: ["#0072b2", "#d55e00", "#009e73", "#a8488a", "#8a6d00", "#3a3f45", "#4fa3d9"],
    dark: ["#56b4e9", "#e69f00", "#2fc79a", "#e07fb5", "#f0e442", "#c9d1d8", "#ff8a50"],
  };
  const SCALE = { light: ["#440154", "#3b528b", "#21918c", "#43ae54"], dark: ["#5d7fd0", "#21a8a0", "#7fd34e", "#fde725"] };
  const root = document.documentElement;
  root.dataset.theme = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
  const css = (name) => getComputedStyle(root).getPropertyValue(name).trim();
  const paletteColour = (i) => { const all = PALETTE[root.dataset.theme]; return all[i % all.length]; };
  const colourings = {
    speed: () => ({
      values: cuts.point.map((k) => data.feed[k]), low: 0, high: usualFeed,
      scale: SCALE[root.dataset.theme].map((c, i, all) => [i / (all.length - 1), c]),
    }),
    tool: () => classes(cuts.point.map((k) => tools.indexOf(data.block_tool[numberAt[k]])), tools.length),
    kind: () => classes(cuts.point.map((k) => data.block_kind[numberAt[k]]), about.kinds.length),
  };
  function classes(values, count) {
    const scale = [];
    for (let i = 0; i < count; i++) scale.push([i / count, paletteColour(i)], [(i + 1) / count, paletteColour(i)]);
    return { values, low: -0.5, high: count - 0.5, scale };
  }
  const chip = (colour, text, name = "") => {
    const mark = document.createElement("i");
    mark.className = name;
    if (colour) mark.style.background = colour;
    const entry = document.createElement("div");
    entry.append(mark, text);
    return entry;
  };
  function drawLegend() {
    const legend = element("legend"), how = element("colour").value;
    legend.replaceChildren();
    if (how === "speed") {
      const bar = document.createElement("div"), ends = document.createElement("div");
      bar.className = "scale"; ends.className = "ends";
      bar.style.background = `linear-gradient(to right, ${SCALE[root.dataset.theme].join(",")})`;
      for (const text of ["0", `${usualFeed < 0.99 * topFeed ? "≥ " : ""}${usualFeed.toFixed(0)} mm/min`]) ends.append(Object.assign(document.createElement("span"), { textContent: text }));
      legend.append(bar, ends);
    } else if (how === "tool") {
      tools.forEach((tool, i) => legend.append(chip(paletteColour(i), `T${tool}`)));
    } else {
      const used = new Set(cuts.point.map((k) => data.block_kind[numberAt[k]]));
      about.kinds.forEach((kind, i) => { if (used.has(i)) legend.append(chip(paletteColour(i), kind)); });
    }
    if (rapids.x.length) legend.append(chip("", "rapid", "rapid"));
    if (other) legend.append(chip(css("--other"), `beside it: ${other.name}`));
  }

  // ---------------------------------------------------------------- the picture
  const VIEWS = { // from where, and what is up
    "3-D": [[-0.5, -0.68, 0.54], [0, 0, 1]], Top: [[0, 0, 1], [0, 1, 0]], Front: [[0, -1, 0], [0, 0, 1]], Side: [[1, 0, 0], [0, 0, 1]],
  };
  const directions = lathe ? ["Front", "3-D"] : Object.keys(VIEWS);
  const VISIBLE = 2; // units of the scene that its height shows
  const xyz = ([x, y, z]) => ({ x, y, z });
  const box = (line) => ["x", "y", "z"].map((name, i) => line[name].reduce(
    ([low, high], v) => (v === null ? [low, high] : [Math.min(low, v), Math.max(high, v)]), lathe && i === 2 ? [0, 0] : [Infinity, -Infinity]));
  const shownBox = cuts.x.length ? box(cuts) : ranges;
  function lookedAt(name, boxes = shownBox) { // camera and size of the scene with which the boxes fill the stage
    const [from, up] = VIEWS[name];
    const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    const unit = (a) => a.map((v) => v / Math.hypot(...a));
    const right = unit(cross(up, from)), upright = unit(cross(from, right));
    const across = (direction) => Math.max(direction.reduce((sum, d, i) => sum + Math.abs(d) * (boxes[i][1] - boxes[i][0]), 0), 0.02 * longest);
    const stage = element("stage"), shape = stage.clientWidth / Math.max(stage.clientHeight, 1);
    const scale = 0.78 * VISIBLE * Math.min(shape / across(right), 1 / across(upright));
    const center = boxes.map(([low, high], i) => scale * ((low + high) / 2 - (ranges[i][0] + ranges[i][1]) / 2));
    const eye = center.map((c, i) => c + 2.5 * from[i]);
    return {
      camera: { eye: xyz(eye), center: xyz(center), up: xyz(up), projection: { type: "orthographic" } },
      aspectratio: xyz(sides.map((side) => scale * side)),
    };
  }
  const sceneAxis = (i, range) => ({
    title: { text: label(i) }, range, visible: i !== undefined, color: css("--soft"), gridcolor: css("--line"),
    zerolinecolor: css("--soft"), backgroundcolor: "rgba(0,0,0,0)", showspikes: false,
  });
  const hidden = (range) => ({ range, visible: false, showspikes: false });
  const frame = () => ({
    margin: { l: 0, r: 0, t: 0, b: 0 }, showlegend: false, paper_bgcolor: "rgba(0,0,0,0)", font: { family: "system-ui, sans-serif", size: 12 }, hovermode: "closest",
  });
  const options = { displayModeBar: false, responsive: true, scrollZoom: true, doubleClick: false };
  const held = lookedAt(directions[0]);
  const alarms = about.remarks.filter((each) => each.kind === "alarm" && points);
  const alarmPlaces = alarms.map((each) => where(each.time_s).axes);
  // Plotly scales by the extent of what is drawn: unseen corners keep that the box, however flat the lines are.
  const corners = { type: "scatter3d", mode: "markers", x: ranges[0], y: ranges[1], z: ranges[2], hoverinfo: "skip", marker: { size: 1, opacity: 0 } };
  function drawPath() {
    const colouring = colourings[element("colour").value]();
    const line = (part, style, width) => ({ type: "scatter3d", mode: "lines", x: part.x, y: part.y, z: part.z, connectgaps: false, hoverinfo: "none", line: { width, ...style } });
    const traces = [
      line(cuts, { color: colouring.values, colorscale: colouring.scale, cmin: colouring.low, cmax: colouring.high }, 4),
      line(rapids, { color: css("--rapid") }, 2),
    ];
    traces.push(corners);
    if (lathe) traces.push(line({ x: ranges[0], y: [0, 0], z: [0, 0] }, { color: css("--soft"), dash: "dashdot" }, 2));
    if (other) {
      const along = (i) => Array.from({ length: other.points }, (_, k) => coordinate((axis) => other.position(k, axis), i));
      traces.push(line({ x: along(ix), y: along(iy), z: along(iz) }, { color: css("--other") }, 3));
      const of = (i) => other.marks.map((mark) => coordinate((axis) => mark.position[axis], i));
      traces.push({ type: "scatter3d", mode: "markers", x: of(ix), y: of(iy), z: of(iz), text: other.marks.map((mark) => mark.text), hoverinfo: "text", marker: { symbol: "diamond-open", size: 9, color: css("--accent"), line: { width: 2 } } });
    }
    if (alarms.length) {
      const of = (i) => alarmPlaces.map((place) => coordinate((axis) => place[axis], i));
      traces.push({ type: "scatter3d", mode: "markers", x: of(ix), y: of(iy), z: of(iz), hoverinfo: "none", marker: { symbol: "x", size: 6, color: css("--accent") } });
    }
    const scene = { xaxis: sceneAxis(ix, ranges[0]), yaxis: sceneAxis(iy, ranges[1]), zaxis: sceneAxis(iz, ranges[2]), aspectmode: "manual", dragmode: lathe ? "pan" : "orbit", ...held };
    return Plotly.react("path", traces, { ...frame(), scene }, options);
  }
  function drawTool() {
    const scene = { xaxis: hidden(ranges[0]), yaxis: hidden(ranges[1]), zaxis: hidden(ranges[2]), aspectmode: "manual", ...held };
    const block = { type: "scatter3d", mode: "lines", x: [], y: [], z: [], line: { width: 9, color: css("--accent") }, hoverinfo: "skip" };
    const mark = { type: "scatter3d", mode: "markers", x: [], y: [], z: [], hoverinfo: "skip", marker: { size: 9, color: css("--accent"), line: { width: 2, color: css("--paper") } } };
    const beside = { ...mark, marker: { size: 8, symbol: "circle-open", color: css("--other"), line: { width: 3 } } };
    const line = { ...block, mode: "lines+markers", line: { width: 5, color: css("--ink") }, marker: { size: 5, color: css("--ink") } };
    return Plotly.react("tool", [mark, block, corners, ...(other ? [beside] : []), line], { ...frame(), scene }, { displayModeBar: false, responsive: true });
  }
  const ruler = other ? 4 : 3; // its place among the lines of the tool's picture
  let following = false;
  function follow(event) { // the tool's picture lies over that of the path and turns with it
    for (const key of ["camera", "aspectratio"]) if (event[`scene.${key}`]) held[key] = event[`scene.${key}`];
    if (following) return;
    following = true;
    requestAnimationFrame(() => { following = false; Plotly.relayout("tool", { "scene.camera": held.camera, "scene.aspectratio": held.aspectratio }); });
  }
  function lookFrom(name, boxes) {
    const { camera, aspectratio } = lookedAt(name, boxes);
    const change = { "scene.camera": camera, "scene.aspectratio": aspectratio };
    Plotly.relayout("path", change);
    follow(change);
  }

  // ---------------------------------------------------------------- the chart under it
  const charts = [{ name: "speed", unit: "mm/min", of: (k) => data.feed[k] }];
  about.axes.forEach((axis, i) => charts.push({ name: `axis ${axis.name}`, unit: axis.unit, of: (k) => position(k, i) }));
  const moving = about.axes.filter((axis) => !axis.part), stretches = data.motion_low ? data.motion_low.length / moving.length / about.derivatives.length : 0;
  if (stretches) moving.forEach((axis, i) => about.derivatives.forEach((name, d) => {
    charts.push({ name: `${name} ${axis.name}`, unit: `${axis.unit}/s${["", "²", "³"][d]}`, at: (d * moving.length + i) * stretches });
  }));
  function stretchPoints(first, from_s, to_s) { // lowest and highest of each stretch; of many together where there are too many
    const begin = Math.max(Math.floor(from_s / about.stretch_s), 0), end = Math.min(Math.ceil(to_s / about.stretch_s), stretches);
    const x = [], y = [], step = Math.max(Math.ceil((end - begin) / (CHART_POINTS / 2)), 1);
    for (let k = begin; k < end; k += step) {
      let low = Infinity, high = -Infinity;
      for (let j = k; j < Math.min(k + step, end); j++) { low = Math.min(low, data.motion_low[first + j]); high = Math.max(high, data.motion_high[first + j]); }
      const t = (k + 0.5) * about.stretch_s;
      x.push(t, t); y.push(low, high);
    }
    return { x, y };
  }
  const CHART_POINTS = 4000;
  function chartPoints(of, left_out, from_s, to_s) { // where many are crowded within a pixel or so: the first, lowest, highest and last
    const first = Math.max(after(data.t_s, from_s) - 1, 0), last = Math.min(after(data.t_s, to_s) + 1, points);
    const x = [], y = [], crowd_s = (to_s - from_s) / (CHART_POINTS / 4);
    let gap = false; // since the last point that is drawn
    for (let k = first, end; k < last; k = end) {
      const kept = new Set();
      for (end = k + 1; end < last && data.t_s[end] < data.t_s[k] + crowd_s;) end++;
      let low = -1, high = -1, begin = -1, close = -1;
      for (let j = k; j < end; j++) {
        if (left_out(j)) continue;
        if (begin < 0) begin = j;
        close = j;
        if (low < 0 || of(j) < of(low)) low = j;
        if (high < 0 || of(j) > of(high)) high = j;
      }
      for (const j of [begin, low, high, close]) kept.add(j);
      for (let j = k; j < end; j++) {
        if (left_out(j)) { gap = true; continue; }
        if (!kept.has(j)) continue;
        if (gap && x.length) { x.push(data.t_s[j]); y.push(null); }
        x.push(data.t_s[j]); y.push(of(j));
        gap = false;
      }
    }
    return { x, y };
  }
  const cursor = (t) => [{ type: "line", x0: t, x1: t, y0: 0, y1: 1, yref: "paper", line: { color: css("--accent"), width: 2 } }];
  let window_s = [0, end_s || 1];
  function drawChart() {
    const chart = charts[element("shown").value];
    const axis = { color: css("--soft"), gridcolor: css("--line"), zeroline: false };
    const speed = chart.name === "speed", calm = topRapid > 2 * topFeed && cuts.x.length > 0;
    const height = speed && calm ? { range: [0, 1.15 * topFeed] } : { rangemode: speed ? "tozero" : "normal" };
    const faster = { text: `rapids, to ${topRapid.toFixed(0)}, are left out`, showarrow: false, xref: "paper", yref: "paper", x: 1, y: 1, xanchor: "right", yanchor: "top", bgcolor: css("--panel"), font: { color: css("--soft"), size: 11 } };
    return Plotly.react("chart", [{ type: "scatter", mode: "lines", ...(chart.of ? chartPoints(chart.of, speed && calm ? (k) => data.rapid[k] : () => false, ...window_s) : stretchPoints(chart.at, ...window_s)), line: { color: paletteColour(0), width: 1.5 }, hovertemplate: "%{x:.3f} s: %{y:.3f}<extra></extra>" }], {
      ...frame(), margin: { l: 64, r: 8, t: 8, b: 34 }, plot_bgcolor: "rgba(0,0,0,0)", hovermode: "x", dragmode: "zoom",
      xaxis: { ...axis, title: { text: "time [s]", standoff: 4 }, range: [...window_s], minallowed: 0, maxallowed: end_s || 1 },
      yaxis: { ...axis, title: { text: chart.unit }, fixedrange: true, ...height, tickformat: ",~g" }, shapes: cursor(now), annotations: speed && calm ? [faster] : [],
    }, { displayModeBar: false, responsive: true });
  }

  // ---------------------------------------------------------------- the listing: only the lines in sight exist
  const ROW_PX = 20;
  const listing = element("listing"), rows = element("rows");
  const remarkOf = new Map(about.remarks.map((each) => [each.row, each]).reverse());
  rows.style.height = `${about.text.length * ROW_PX}px`;
  let lit = -1;
  function drawListing() {
    const first = Math.max(Math.floor(listing.scrollTop / ROW_PX) - 5, 0);
    const last = Math.min(first + Math.ceil(listing.clientHeight / ROW_PX) + 10, about.text.length);
    const shown = [];
    for (let i = first; i < last; i++) {
      const row = document.createElement("div"), number = document.createElement("b"), remark = remarkOf.get(i);
      row.className = ["row", data.line[i] ? "" : "name", i === lit ? "lit" : "", remark ? remark.kind : ""].join(" ");
      row.style.top = `${i * ROW_PX}px`;
      row.dataset.row = i;
      row.setAttribute("role", "option");
      row.setAttribute("aria-selected", i === lit);
      if (remark) row.title = remark.text;
      if (data.line[i]) { number.textContent = data.line[i]; row.append(number); }
      row.append(about.text[i]);
      shown.push(row);
    }
    rows.replaceChildren(...shown);
  }
  function light(row) {
    lit = row;
    const top = row * ROW_PX;
    if (row >= 0 && (top < listing.scrollTop || top + ROW_PX > listing.scrollTop + listing.clientHeight)) {
      listing.scrollTop = top - listing.clientHeight / 2;
    }
    drawListing();
  }
  function goToRow(row) { // its next execution after this moment, or else its first
    const here = executionAt(now);
    for (let step = 1; step <= executions; step++) {
      const execution = (here + step) % executions;
      if (rowOf(execution) === row) { goToExecution(execution); return; }
    }
    say(`Line ${data.line[row]} takes no time.`);
  }
  function goToExecution(execution) {
    const clamped = Math.min(Math.max(execution, 0), executions - 1);
    if (executions) goTo(data.start_s[clamped] + 2e-6);
  }
  const say = (text) => { element("status").textContent = text; };

  // ---------------------------------------------------------------- the moment that is shown
  let now = 0, playing = false, before_ms = 0, shownExecution = -1;
  const clockText = (s) => {
    const minutes = Math.floor(s / 60), hours = Math.floor(minutes / 60), rest = (s - 60 * minutes).toFixed(3).padStart(6, "0");
    return hours ? `${hours}:${String(minutes % 60).padStart(2, "0")}:${rest}` : `${minutes}:${rest}`;
  };
  const cells = {};
  for (const name of ["time", "speed", "tool", "line", ...about.axes.map((axis) => axis.name), ...(lathe ? ["⌀"] : [])]) {
    const cell = document.createElement("dd");
    cell.dataset.of = name;
    element("readout").append(Object.assign(document.createElement("dt"), { textContent: name }), cell);
    cells[name] = cell;
  }
  function goTo(t) {
    now = Math.min(Math.max(t, 0), end_s);
    element("slider").value = now;
    element("slider").setAttribute("aria-valuetext", `${now.toFixed(3)} seconds`);
    element("clock").textContent = `${clockText(now)} / ${clockText(end_s)}`;
    cells.time.textContent = `${now.toFixed(3)} s`;
    if (!points) return;
    const here = where(now), execution = executionAt(now), block = data.number[execution];
    about.axes.forEach((axis, i) => { cells[axis.name].textContent = `${here.axes[i].toFixed(3)} ${axis.unit === "deg" ? "°" : "mm"}`; });
    if (lathe) cells["⌀"].textContent = `${(2 * here.axes[iz]).toFixed(3)} mm`;
    cells.speed.textContent = `${here.feed.toFixed(0)} mm/min`;
    const row = rowOf(execution);
    cells.tool.textContent = executions ? `T${data.block_tool[block]}` : "";
    cells.line.textContent = row >= 0 ? data.line[row] : "";
    if (row !== lit) light(row);
    const place = [ix, iy, iz].map((i) => coordinate((axis) => here.axes[axis], i));
    const change = { x: [[place[0]]], y: [[place[1]]], z: [[place[2]]] }, which = [0];
    if (other && other.points) {
      const k = Math.min(after(data.other_t_s, now), other.points - 1), j = Math.max(k - 1, 0), span = data.other_t_s[k] - data.other_t_s[j];
      const share = span > 0 ? Math.min(Math.max((now - data.other_t_s[j]) / span, 0), 1) : 0;
      const there = [ix, iy, iz].map((i) => coordinate((axis) => other.position(j, axis) + share * (other.position(k, axis) - other.position(j, axis)), i));
      change.x.push([there[0]]); change.y.push([there[1]]); change.z.push([there[2]]); which.push(3);
    }
    if (execution !== shownExecution) {
      shownExecution = execution;
      const [x, y, z] = blockLine(execution);
      change.x.push(x); change.y.push(y); change.z.push(z); which.push(1);
    }
    Plotly.restyle("tool", change, which);
    Plotly.relayout("chart", { shapes: cursor(now) });
  }
  function blockLine(execution) {
    const from_s = data.start_s[execution], to_s = execution + 1 < executions ? data.start_s[execution + 1] : end_s;
    const places = [where(from_s).axes];
    for (let k = after(data.t_s, from_s); k < points && data.t_s[k] < to_s; k++) places.push(about.axes.map((_, i) => position(k, i)));
    places.push(where(to_s).axes);
    return [ix, iy, iz].map((i) => places.map((place) => coordinate((axis) => place[axis], i)));
  }
  function play(on) {
    playing = on && end_s > 0;
    element("play").textContent = playing ? "❚❚" : "▶";
    element("play").setAttribute("aria-label", playing ? "Stop" : "Play");
    if (!playing) return;
    if (now >= end_s) now = 0;
    before_ms = performance.now();
    requestAnimationFrame(tick);
  }
  function tick(at_ms) {
    if (!playing) return;
    goTo(now + Math.max(at_ms - before_ms, 0) / 1000 * Number(element("rate").value));
    before_ms = at_ms;
    if (now >= end_s) play(false); else requestAnimationFrame(tick);
  }

  // ---------------------------------------------------------------- what stands around it
  element("title").textContent = about.program.split(/[\\/]/).pop();
  element("title").title = about.program;
  element("summary").textContent = `${about.machine} · ${about.summary}${about.ok ? "" : " · stopped by an alarm"}`;
  element("note").textContent = about.note;
  element("slider").max = end_s;
  for (const rate of [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000]) element("rate").add(new Option(`${rate}×`, rate, rate === 10, rate === 10));
  charts.forEach((chart, i) => element("shown").add(new Option(chart.name, i)));
  directions.forEach((name) => {
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: lathe && name === "Front" ? "Profile" : name });
    button.onclick = () => lookFrom(name);
    element("views").append(button);
  });
  element("views").append(Object.assign(document.createElement("button"), {
    type: "button", textContent: "All", title: "Everything, rapids too", onclick: () => lookFrom(directions[0], ranges),
  }));
  function drawTools() {
    const body = element("tools").tBodies[0];
    body.replaceChildren();
    about.tools.forEach((each) => {
      const row = body.insertRow(), share = (each.cutting_s + each.rapid_s) / Math.max(about.time_s, 1e-9);
      row.insertCell().append(chip(paletteColour(tools.indexOf(each.tool)), `T${each.tool}`));
      for (const text of [clockText(each.cutting_s), clockText(each.rapid_s), `${(100 * share).toFixed(1)} %`]) row.insertCell().textContent = text;
    });
    element("tools").hidden = !about.tools.length;
    const jobs = element("operations").tBodies[0];
    jobs.replaceChildren();
    about.operations.forEach((each) => {
      const row = jobs.insertRow(), name = Object.assign(document.createElement("button"), { type: "button", textContent: each.name || `T${each.tool}` });
      name.onclick = () => { if (each.row >= 0) { light(each.row); listing.scrollTop = each.row * ROW_PX; } };
      row.insertCell().append(name);
      for (const time of [each.cutting_s, each.time_s]) row.insertCell().textContent = clockText(time);
    });
    element("operations").hidden = about.operations.length < 2;
  }
  let measured = null; // null: clicks go to moments; else the places clicked
  function measure(place) {
    measured.push(place);
    if (measured.length < 2) { say("Now the other place."); return; }
    const [from, to] = measured, off = from.map((v, i) => to[i] - v);
    const names = [ix, iy, iz].map((i) => (i === undefined ? "" : about.axes[i].name));
    const parts = off.flatMap((d, i) => (names[i] ? [`${names[i]} ${d.toFixed(3)}`] : []));
    say(`Distance ${Math.hypot(...off).toFixed(3)} mm (${parts.join(", ")})`);
    Plotly.restyle("tool", { x: [[from[0], to[0]]], y: [[from[1], to[1]]], z: [[from[2], to[2]]] }, [ruler]);
    measured = [];
  }
  element("measure").onclick = () => {
    measured = measured ? null : [];
    element("measure").setAttribute("aria-pressed", String(Boolean(measured)));
    say(measured ? "Click two places on the path." : "");
    if (!measured) Plotly.restyle("tool", { x: [[]], y: [[]], z: [[]] }, [ruler]);
  };
  element("frames").hidden = !hasPart;
  element("frame").value = inPart ? "part" : "machine";
  element("frame").onchange = () => { window.name = element("frame").value === "part" ? "polycnc part" : ""; location.reload(); };
  for (const each of about.remarks) {
    const button = Object.assign(document.createElement("button"), { type: "button", className: each.kind });
    button.textContent = `${each.kind === "alarm" ? "▲ alarm" : "● remark"}${each.line ? `, line ${each.line}` : ""}: ${each.text}`;
    button.onclick = () => { if (each.time_s !== null) goTo(each.time_s); else if (each.row >= 0) goToRow(each.row); if (each.row >= 0) light(each.row); };
    element("remarks").appendChild(document.createElement("li")).append(button);
  }
  for (const mark of other ? other.marks : []) {
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: `◇ ${mark.text}` });
    button.onclick = () => { if (mark.time_s !== null) goTo(mark.time_s); };
    element("remarks").appendChild(document.createElement("li")).append(button);
  }
  if (other) element("summary").textContent += ` · beside ${other.name}`;
  if (!points) say("The program moves no axis.");
  listing.onscroll = drawListing;
  rows.onclick = (event) => { const row = event.target.closest(".row"); if (row && data.line[row.dataset.row]) { say(""); goToRow(Number(row.dataset.row)); } };
  element("slider").oninput = () => goTo(Number(element("slider").value));
  element("play").onclick = () => play(!playing);
  element("colour").onchange = () => { drawLegend(); drawPath(); };
  element("shown").onchange = drawChart;
  element("theme").onclick = () => { root.dataset.theme = root.dataset.theme === "dark" ? "light" : "dark"; draw(); };
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const on = event.target.tagName;
    if (on === "SELECT" || ((on === "BUTTON" || on === "SUMMARY") && [" ", "Enter"].includes(event.key))) return;
    const rate = element("rate"), colour = element("colour");
    const faster = (by) => { rate.selectedIndex = Math.min(Math.max(rate.selectedIndex + by, 0), rate.options.length - 1); };
    const actions = {
      " ": () => play(!playing), ArrowLeft: () => goToExecution(executionAt(now) - 1), ArrowRight: () => goToExecution(executionAt(now) + 1),
      PageUp: () => goToExecution(executionAt(now) - 10), PageDown: () => goToExecution(executionAt(now) + 10),
      Home: () => goTo(0), End: () => goTo(end_s), "+": () => faster(1), "-": () => faster(-1),
      c: () => { colour.selectedIndex = (colour.selectedIndex + 1) % colour.options.length; colour.onchange(); },
    };
    directions.forEach((name, i) => { actions[i + 1] = () => lookFrom(name); });
    const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (action) { event.preventDefault(); action(); }
  });

  async function draw() {
    drawTools(); drawLegend();
    await drawPath(); await drawTool(); await drawChart();
    shownExecution = -1; lit = -2;
    goTo(now);
  }
  await draw();
  element("path").on("plotly_relayouting", follow);
  element("path").on("plotly_relayout", follow);
  element("path").on("plotly_click", ({ points: [hit] }) => {
    const part = [cuts, rapids][hit.curveNumber];
    if (measured) measure([hit.x, hit.y, hit.z]);
    else if (part) goTo(part.time[hit.pointNumber]);
  });
  element("chart").on("plotly_click", ({ points: [hit] }) => goTo(hit.x));
  element("chart").on("plotly_relayout", (event) => {
    const zoomed = event["xaxis.range[0]"] !== undefined;
    if (!zoomed && !event["xaxis.autorange"]) return;
    window_s = zoomed ? [event["xaxis.range[0]"], event["xaxis.range[1]"]] : [0, end_s || 1];
    drawChart();
  });
  new ResizeObserver(drawListing).observe(listing);
  root.dataset.ready = "yes";
})();
