// Values by name: parameters, found by a word, and variables and signals that are watched.
import { kept, make, row, table } from "/dom.js";
import { Page } from "/page_base.js";
import { TEXTS } from "/texts.js";

const MOST_ROWS = 60;
const parse = (text) => (text === "" ? null : text === "true" || text === "false" ? text === "true" : Number.isNaN(Number(text)) ? text : Number(text));
const text = (value) => (value === null || value === undefined ? "" : String(value));

class Values extends Page {
  cells(part, each) {
    const cell = make("span", { class: "values" });
    const set = (value) => this.send("PUT", `${part}/${encodeURIComponent(each.name)}`, { value });
    const one = (value, label, wrap) => {
      if (!each.writable) return make("span", {}, text(value), " ");
      if (typeof value === "boolean" || each.choices.length) return this.choice(value, label, each.choices.length ? each.choices : ["true", "false"], (found) => set(wrap(found)));
      return this.input(value, label, (found) => set(wrap(parse(found))));
    };
    if (each.value && typeof each.value === "object" && !Array.isArray(each.value)) {
      for (const [axis, value] of Object.entries(each.value)) cell.append(make("label", {}, `${axis}: `, one(value, `${each.name} ${axis}`, (found) => ({ [axis]: found }))));
    } else cell.append(one(Array.isArray(each.value) ? each.value.join(", ") : each.value, each.name, (found) => found));
    return cell;
  }
  choice(value, label, words, set) {
    const made = make("select", { "aria-label": label, class: "cell" }, ...words.map((word) => make("option", {}, word)));
    made.value = String(value);
    return this.marked(made, (found) => set(parse(found)));
  }
  rows(part, all) {
    return table([TEXTS.number, TEXTS.value, TEXTS.meaning], all.slice(0, MOST_ROWS).map((each) => row(each.name, this.cells(part, each), each.what)));
  }
}

class Parameters extends Values {
  static needs = "parameters";
  async show() {
    if (!this.filter) {
      this.filter = make("input", { id: "filter", type: "search", placeholder: TEXTS.filter, "aria-label": TEXTS.filter, oninput: () => this.find() });
      this.place = make("div");
      this.replaceChildren(this.filter, this.place);
    }
    this.all = (await this.newest("parameters")) ?? this.all;
    if (!this.writes(this.place)) this.find();
  }
  find() {
    const word = this.filter.value.toLowerCase(), found = (this.all ?? []).filter((each) => `${each.name} ${each.what}`.toLowerCase().includes(word));
    this.place.replaceChildren(this.all ? this.rows("parameters", found) : "", found.length > MOST_ROWS ? make("p", { class: "hint" }, TEXTS.more(found.length - MOST_ROWS)) : "");
  }
}
customElements.define("cnc-page-parameters", Parameters);

// Values that are read again and again; those that the viewer names, else the usual ones or all.
class Watched extends Values {
  static every_ms = 500;
  get name() { return `watched-${this.constructor.needs}`; }
  show() {
    const part = this.constructor.needs, names = make("input", { id: this.name, class: "watched", placeholder: TEXTS.watch[part], "aria-label": TEXTS.watch[part], value: this.names });
    names.addEventListener("change", () => { kept.set(`${this.name}-${this.link.name}`, names.value); this.again(); });
    this.list = make("div");
    this.replaceChildren(names, this.list);
    this.again();
  }
  get names() { return kept.get(`${this.name}-${this.link.name}`, this.constructor.usual(this.link.kind)); }
  async again() {
    if (this.list.contains(document.activeElement)) return; // somebody writes into it
    const part = this.constructor.needs, all = await this.newest(`${part}?names=${encodeURIComponent(this.names)}`);
    if (all && !this.list.contains(document.activeElement)) this.list.replaceChildren(all.length ? this.rows(part, all) : TEXTS.none, all.length > MOST_ROWS ? make("p", { class: "hint" }, TEXTS.more(all.length - MOST_ROWS)) : "");
  }
}
class Variables extends Watched {
  static needs = "variables";
  static usual() { return ""; }
}
customElements.define("cnc-page-variables", Variables);
class Signals extends Watched {
  static needs = "signals";
  static usual(kind) { return kind === "fanuc" ? "G8, G10, G11, G12, G14, G30, G43, G46, F0, F1, X4, X8, X9, Y8, R0, K0, D0" : ""; }
}
customElements.define("cnc-page-signals", Signals);
