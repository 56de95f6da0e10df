// What every page of the tabs has: the link to its machine, cells in which values are set, being open or not.
import { make, say } from "/dom.js";
import { TEXTS } from "/texts.js";

export class Page extends HTMLElement {
  // `every_ms`: how often `again` is called while the page is open; `follows`: parts of the inventory that it shows.
  static every_ms = 0;
  static follows = [];
  static needs = null;

  start(link, parts) { Object.assign(this, { link, parts }); return this; }
  open() {
    this.show();
    const { every_ms } = this.constructor;
    clearInterval(this.timer);
    if (every_ms) this.timer = setInterval(() => { if (!document.hidden) this.again(); }, every_ms);
  }
  close() { clearInterval(this.timer); }
  show() {}
  again() {}
  changed(parts) {
    if (this.constructor.follows.some((name) => parts[name]) && !this.contains(document.activeElement)) this.show();
  }

  // A cell whose value is set when it is changed; refused ones stay marked.
  input(value, label, change) {
    const made = make("input", { value: value ?? "", "aria-label": label, inputmode: "decimal", class: "cell" });
    made.addEventListener("change", async () => { made.classList.toggle("refused", !(await change(made.value.trim()))); });
    return made;
  }
  number(text, use) {
    const found = text === "" ? NaN : Number(text.replace(",", "."));
    if (Number.isFinite(found)) return use(found);
    say(TEXTS.no_number);
    return false;
  }
}
