"use strict";
(async () => {
  const element = (id) => document.getElementById(id);
  if (typeof DecompressionStream === "undefined") {
    element("counts").textContent = "This page needs a browser of 2023 or later.";
    return;
  }
  const bytes = Uint8Array.from(atob(element("data").textContent.trim()), (c) => c.charCodeAt(0));
  element("data").textContent = "";
  const all = await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).json();

  // ---------------------------------------------------------------- columns: only those that tell something
  const varies = (name) => all.some((each) => each[name] !== all[0][name]);
  const has = (name) => all.some((each) => each[name] !== null);
  const clock = (s) => {
    if (s === null) return "";
    const h = Math.floor(s / 3600), m = Math.floor((s - 3600 * h) / 60), rest = (s - 3600 * h - 60 * m).toFixed(1).padStart(4, "0");
    return h ? `${h}:${String(m).padStart(2, "0")}:${rest}` : `${m}:${rest}`;
  };
  const length = (mm) => (mm === null ? "" : mm.toLocaleString("en", { maximumFractionDigits: 0 }));
  const pictured = all.some((each) => each.thumbnail);
  const columns = [
    pictured && { title: "", width: "76px" },
    { title: "program", width: "minmax(140px, 3fr)", of: (each) => each.program, text: (each) => each.program },
    varies("machine") && { title: "machine", width: "minmax(60px, 1fr)", of: (each) => each.machine, text: (each) => each.machine },
    varies("override_percent") && { title: "override %", width: "80px", of: (each) => each.override_percent, text: (each) => String(each.override_percent), number: true },
    varies("tolerance_mm") && { title: "tolerance mm", width: "96px", of: (each) => each.tolerance_mm, text: (each) => (each.tolerance_mm === null ? "free" : String(each.tolerance_mm)), number: true },
    { title: "result", width: "96px", of: (each) => [each.status === "ok" ? 1 : 0, each.status].join(), text: (each) => (each.status === "ok" ? "ok" : each.errors.length > 1 ? `${each.errors.length} errors` : each.status), bad: (each) => each.status !== "ok" },
    has("time_s") && { title: "time", width: "84px", of: (each) => each.time_s, text: (each) => clock(each.time_s), number: true },
    has("time_s") && { title: "cutting", width: "84px", of: (each) => each.cutting_time_s, text: (each) => clock(each.cutting_time_s), number: true },
    has("time_s") && { title: "path mm", width: "84px", of: (each) => each.path_mm, text: (each) => length(each.path_mm), number: true },
    has("blocks") && { title: "blocks", width: "76px", of: (each) => each.blocks, text: (each) => length(each.blocks), number: true },
    { title: "remarks", width: "64px", of: (each) => each.messages.length, text: (each) => String(each.messages.length || ""), number: true },
  ].filter(Boolean);
  element("list").style.setProperty("--columns", columns.map((column) => column.width).join(" "));

  // ---------------------------------------------------------------- what is shown, and in what order
  let order = null, falling = false, shown = all, lit = null;
  const text = new Map();
  const textOf = (each) => {
    if (!text.has(each)) text.set(each, [each.program, each.machine, each.status, ...each.errors, ...each.messages].join("\n").toLowerCase());
    return text.get(each);
  };
  function choose() {
    const words = element("find").value.toLowerCase().split(/\s+/).filter(Boolean), kind = element("show").value;
    shown = all.filter((each) => (kind === "all" || (kind === "good") === each.ok) && words.every((word) => textOf(each).includes(word)));
    if (order) {
      const value = columns[order].of;
      shown.sort((a, b) => {
        const x = value(a), y = value(b);
        if (x === y) return 0;
        if (x === null || y === null) return x === null ? 1 : -1; // what has no value comes last
        return (x < y ? -1 : 1) * (falling ? -1 : 1);
      });
    }
    const good = all.reduce((sum, each) => sum + each.ok, 0), time = shown.reduce((sum, each) => sum + (each.time_s || 0), 0);
    element("counts").textContent = `${all.length.toLocaleString("en")} runs, ${(all.length - good).toLocaleString("en")} with errors · ${shown.length.toLocaleString("en")} shown${time ? `, ${clock(time)} in all` : ""}`;
    [...element("heads").children].forEach((head, i) => head.setAttribute("aria-sort", i === order ? (falling ? "descending" : "ascending") : "none"));
    [...element("heads").children].forEach((head, i) => { head.textContent = columns[i].title + (i === order ? (falling ? " ▾" : " ▴") : ""); });
    element("rows").style.height = `${shown.length * ROW_PX}px`;
    draw();
  }

  // ---------------------------------------------------------------- only the rows in sight exist
  const ROW_PX = 48;
  const NS = "http://www.w3.org/2000/svg";
  function picture(each, width) {
    const svg = document.createElementNS(NS, "svg");
    svg.setAttribute("viewBox", "0 0 96 64");
    svg.setAttribute("width", width);
    svg.setAttribute("height", width * 64 / 96);
    svg.setAttribute("role", "img");
    svg.setAttribute("aria-label", "path");
    if (each.thumbnail) ["cut", "rapid"].forEach((kind, i) => {
      const path = document.createElementNS(NS, "path");
      path.setAttribute("class", kind);
      path.setAttribute("d", each.thumbnail[i]);
      svg.append(path);
    });
    return svg;
  }
  function draw() {
    const scroll = element("scroll");
    const first = Math.max(Math.floor(scroll.scrollTop / ROW_PX) - 4, 0);
    const last = Math.min(first + Math.ceil(scroll.clientHeight / ROW_PX) + 8, shown.length);
    const rows = [];
    for (let i = first; i < last; i++) {
      const row = document.createElement("div"), each = shown[i];
      row.className = `row${each === lit ? " lit" : ""}`;
      row.setAttribute("role", "row");
      row.style.top = `${i * ROW_PX}px`;
      row.dataset.at = i;
      for (const column of columns) {
        if (!column.of) { row.append(picture(each, 66)); continue; }
        const cell = document.createElement("span");
        cell.className = [column.number ? "number" : "", column.bad && column.bad(each) ? "bad" : ""].join(" ");
        cell.textContent = cell.title = column.text(each);
        row.append(cell);
      }
      rows.push(row);
    }
    element("rows").replaceChildren(...rows);
  }
  function goTo(i) {
    if (!shown.length) return;
    const at = Math.min(Math.max(i, 0), shown.length - 1), scroll = element("scroll"), top = at * ROW_PX;
    lit = shown[at];
    if (top < scroll.scrollTop) scroll.scrollTop = top;
    if (top + ROW_PX > scroll.scrollTop + scroll.clientHeight) scroll.scrollTop = top + ROW_PX - scroll.clientHeight;
    draw();
    detail(lit);
  }

  // ---------------------------------------------------------------- one program
  const made = (name, content, kind) => Object.assign(document.createElement(name), { textContent: content, className: kind || "" });
  function table(heads, rows) {
    const found = document.createElement("table"), head = found.createTHead().insertRow();
    heads.forEach(([title, kind]) => head.append(made("th", title, kind)));
    const body = found.createTBody();
    rows.forEach((cells) => { const row = body.insertRow(); cells.forEach((cell, i) => row.append(made("td", cell, heads[i][1]))); });
    return found;
  }
  function detail(each) {
    const parts = [made("h2", each.program)];
    const about = [each.machine, each.dialect, varies("override_percent") && `override ${each.override_percent} %`, varies("tolerance_mm") && `tolerance ${each.tolerance_mm} mm`];
    parts.push(made("p", about.filter(Boolean).join(" · "), "soft"));
    if (each.thumbnail) parts.push(picture(each, 360));
    if (each.errors.length) parts.push(made("h3", "Errors"), ...each.errors.map((error) => made("pre", error)));
    if (each.time_s !== null) parts.push(made("h3", "Time"), table([["", "text"], [""]], [["all", clock(each.time_s)], ["cutting", clock(each.cutting_time_s)], ["waiting", clock(each.waiting_time_s)]]));
    if (each.tools.length) parts.push(made("h3", "Time per tool"), table([["tool", "text"], ["cutting"], ["rapid"]], each.tools.map(([tool, cutting, rapid]) => [`T${tool}`, clock(cutting), clock(rapid)])));
    if (each.slowest.length) parts.push(made("h3", "Slowest blocks"), table([["line"], ["time"], ["block", "text"]], each.slowest.map(([line, block, time]) => [line || "", clock(time), block])));
    if (each.extents.length) parts.push(made("h3", "Extents"), table([["axis", "text"], ["lowest"], ["highest"]], each.extents.map(([axis, low, high]) => [axis, low.toFixed(3), high.toFixed(3)])));
    if (each.messages.length) parts.push(made("h3", "Remarks"), ...each.messages.map((message) => made("p", message)));
    element("details").replaceChildren(...parts);
  }

  columns.forEach((column, i) => {
    const head = Object.assign(document.createElement("button"), { type: "button", className: column.number ? "number" : "", disabled: !column.of });
    head.setAttribute("role", "columnheader");
    head.onclick = () => { falling = order === i ? !falling : Boolean(column.number); order = i; choose(); };
    element("heads").append(head);
  });
  element("find").oninput = element("show").onchange = choose;
  element("scroll").onscroll = draw;
  element("rows").onclick = (event) => { const row = event.target.closest(".row"); if (row) goTo(Number(row.dataset.at)); };
  element("scroll").onkeydown = (event) => {
    const by = { ArrowDown: 1, ArrowUp: -1, PageDown: 10, PageUp: -10 }[event.key];
    if (by) { event.preventDefault(); goTo(shown.indexOf(lit) + by); }
  };
  new ResizeObserver(draw).observe(element("scroll"));
  choose();
  document.documentElement.dataset.ready = "yes";
})();
