// What every page of the tabs has: the link to its machine, cells in which values are set, being open or not.
import { make, say } from "/dom.js";
import { TEXTS } from "/texts.js";

export class Page extends HTMLElement {
  // `every_ms`: how often `again` is called while the page is open; `follows`: parts of the inventory that it shows.
  static every_ms = 0;
  static follows = [];
  static needs = null;

  start(link, parts) { Object.assign(this, { link, parts, asked: 0, shown_turn: 0, isStale: false, isRefused: false, last: Promise.resolve() }); return this; }
  open() {
    this.isStale = false;
    this.show();
    const { every_ms } = this.constructor;
    clearInterval(this.timer);
    if (every_ms) this.timer = setInterval(() => { if (!document.hidden && !this.link.lost && !this.isRefused) this.again(); }, every_ms);
  }
  close() { clearInterval(this.timer); }
  show() {}
  again() {}
  changed(parts) {
    this.isStale ||= this.constructor.follows.some((name) => parts[name]);
    if (this.isStale && !this.contains(document.activeElement)) this.renew();
  }
  // Show it anew; what somebody is writing into, as soon as he has left it.
  renew() {
    this.isStale = this.writes(this);
    if (!this.isStale) this.show();
  }
  writes(place) { return place.contains(document.activeElement) && document.activeElement.matches("input, select, textarea"); }

  // What is told now; null if it is refused (the timer asks no more then), does not come, or something later is shown already.
  async newest(rest) {
    const turn = ++this.asked;
    this.isRefused = false;
    const told = await this.link.json(rest);
    if (turn < this.shown_turn) return null;
    if (told) this.shown_turn = turn; else this.isRefused = told === null;
    return told ?? null;
  }
  // What is answered to something that was done here is later than all that was asked before.
  answered() { this.shown_turn = ++this.asked; }

  // Changes are sent one after the other, in the order of the presses, to the machine of the press.
  send(method, rest, body) {
    const at = this.link.url(rest);
    this.last = this.last.then(() => this.link.send(method, rest, body, at));
    return this.last;
  }

  // A cell whose value is set when it is changed; refused ones stay marked.
  input(value, label, change) {
    const made = make("input", { value: value ?? "", "aria-label": label, inputmode: "decimal", class: "cell" });
    return this.marked(made, (text) => change(text.trim()));
  }
  marked(made, change) {
    made.addEventListener("change", async () => {
      const text = made.value, isDone = await change(text);
      if (made.value === text) made.classList.toggle("refused", !isDone);
    });
    return made;
  }
  number(text, use) {
    const found = text === "" ? NaN : Number(text.replace(",", "."));
    if (Number.isFinite(found)) return use(found);
    say(TEXTS.no_number);
    return false;
  }
}
