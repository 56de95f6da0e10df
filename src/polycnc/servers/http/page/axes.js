// The table of the axes; of a board or card, which has no control, all that its status has.
import { make, put } from "/dom.js";
import { TEXTS } from "/texts.js";

const COLUMNS = ["work", "machine", "relative", "to_go", "error", "load"], OPTIONAL = ["relative", "error", "load"];
const kind = (key) => (OPTIONAL.includes(key) ? "optional" : key);
const number = (value) => (typeof value === "number" && !Number.isInteger(value) ? value.toFixed(3) : String(value));

class Axes extends HTMLElement {
  // Those that are not `own` belong to another channel.
  show(axes, own) {
    if (this.names !== Object.keys(axes).join()) this.build(axes);
    for (const [name, axis] of Object.entries(axes)) {
      const cells = this.cells[name];
      for (const key of ["work", "machine", "relative", "to_go"]) put(cells[key], axis[key].toFixed(3));
      put(cells.error, axis.following_error.toFixed(3));
      put(cells.load, `${axis.load_percent.toFixed(0)} %`);
      cells.row.classList.toggle("other", !own.includes(name));
      cells.name.classList.toggle("unreferenced", !axis.referenced);
      cells.name.title = axis.referenced ? "" : TEXTS.unreferenced;
    }
  }

  build(axes) {
    this.names = Object.keys(axes).join();
    this.cells = {};
    const head = make("tr", {}, make("th", { scope: "col" }, TEXTS.axis), ...COLUMNS.map((key) => make("th", { class: kind(key), scope: "col" }, TEXTS[key])));
    const rows = Object.entries(axes).map(([name, axis]) => {
      const cells = (this.cells[name] = { name: make("th", { scope: "row" }, name, make("small", {}, axis.unit === "deg" ? "°" : "")) });
      for (const key of COLUMNS) cells[key] = make("td", { class: kind(key), id: `${name}-${key}` });
      return (cells.row = make("tr", {}, ...Object.values(cells)));
    });
    this.replaceChildren(make("table", {}, head, ...rows));
  }

  showBoard(status) {
    const { axes, cycle, time_s, ...others } = status, columns = Object.keys(axes[0] ?? {});
    this.names = "";
    const rows = axes.map((axis, index) => make("tr", {}, make("th", { scope: "row" }, String(index)), ...columns.map((key) => make("td", {}, number(axis[key])))));
    const bits = Object.entries(others).map(([name, value]) => make("tr", {}, make("th", { scope: "row" }, name), make("td", {}, number(value))));
    this.replaceChildren(make("table", {}, make("tr", {}, make("th", {}, TEXTS.axis), ...columns.map((key) => make("th", {}, key))), ...rows),
      make("table", { class: "bits" }, ...bits));
  }
}
customElements.define("cnc-axes", Axes);
