// A text with numbers of its lines, and what is wrong with a line right under it.
import { make } from "/dom.js";

const CLOSE_EM = 1.4, OPEN_EM = 2.6; // the height of a line; there is room for an error under it when there are any

export class Editor extends HTMLElement {
  // Fires `input` as its textarea does.
  connectedCallback() {
    if (this.text) return;
    this.text = make("textarea", { id: this.getAttribute("for"), "aria-label": this.getAttribute("label"), spellcheck: "false", autocapitalize: "off", wrap: "off" });
    this.layer = make("div", { class: "layer", "aria-hidden": "true" });
    this.errors = [];
    this.replaceChildren(this.text, this.layer);
    for (const type of ["scroll", "input"]) this.text.addEventListener(type, () => this.draw());
    new ResizeObserver(() => this.draw()).observe(this.text);
  }

  get value() { return this.text.value; }
  set value(text) { this.text.value = text; this.text.scrollTop = 0; this.show([]); }

  // Show errors: {line, column, text, hint}, lines from 1.
  show(errors) {
    const open = errors.length > 0, changed = open !== this.classList.contains("open");
    const first = this.text.scrollTop / this.height;
    this.errors = errors;
    this.classList.toggle("open", open);
    if (changed) this.text.scrollTop = first * this.height; // the line on top stays there
    this.draw();
  }
  get height() { return parseFloat(getComputedStyle(this.text).fontSize) * (this.classList.contains("open") ? OPEN_EM : CLOSE_EM); }

  go(line, column = 1) {
    const lines = this.value.split("\n"), at = lines.slice(0, line - 1).reduce((sum, each) => sum + each.length + 1, 0) + Math.max(column - 1, 0);
    this.text.focus();
    this.text.setSelectionRange(at, at);
    this.text.scrollTop = (line - 1) * this.height - this.text.clientHeight / 2;
  }

  // Only what is in sight is in the layer.
  draw() {
    const { height, text } = this, count = text.value.split("\n").length, top = parseFloat(getComputedStyle(text).paddingTop);
    const first = Math.max(0, Math.floor((text.scrollTop - top) / height)), last = Math.min(count, Math.ceil((text.scrollTop + text.clientHeight) / height) + 1);
    const wrong = new Map();
    for (const error of this.errors) if (!wrong.has(error.line)) wrong.set(error.line, error);
    const rows = [];
    for (let k = first; k < last; k++) {
      const error = wrong.get(k + 1), place = `${top + k * height - text.scrollTop}px`, number = make("b", { class: error ? "wrong" : "" }, String(k + 1));
      number.style.top = place;
      rows.push(number);
      if (!error) continue;
      const caret = make("i", {}, "▲"), said = make("p", {}, caret, ` ${error.text}`);
      said.style.top = `${parseFloat(place) + height / 2}px`;
      said.style.left = `calc(3.6rem + ${Math.max(error.column - 1, 0)}ch - ${text.scrollLeft}px)`;
      rows.push(said);
    }
    this.layer.replaceChildren(...rows);
  }
}
customElements.define("cnc-editor", Editor);
