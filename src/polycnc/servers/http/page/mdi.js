// Blocks put in by hand, and those that were put in before.
import { button, kept, make } from "/dom.js";
import { TEXTS } from "/texts.js";

const MOST = 50;

export class Mdi {
  constructor(link, place) {
    Object.assign(this, { link, past: kept.get("mdi", []), at: -1, draft: "", last: Promise.resolve() });
    this.text = make("textarea", { id: "mdi", rows: "1", placeholder: TEXTS.mdi, "aria-label": TEXTS.mdi, spellcheck: "false", autocapitalize: "characters" });
    this.history = make("select", { id: "history", "aria-label": TEXTS.history, onchange: () => this.recall(Number(this.history.value)) });
    this.text.addEventListener("keydown", (event) => this.key(event));
    this.text.addEventListener("input", () => { this.at = -1; this.fit(); });
    place.replaceChildren(this.text, button("enter", TEXTS.enter, () => this.enter()), this.history);
    this.list();
  }

  list() {
    this.history.replaceChildren(make("option", { value: "-1" }, TEXTS.history), ...this.past.map((text, k) => make("option", { value: String(k) }, text.replaceAll("\n", " ⏎ "))));
    this.history.hidden = !this.past.length;
  }
  fit() { this.text.rows = Math.min(this.text.value.split("\n").length, 6); }

  key(event) {
    if (event.altKey) return;
    if (event.key === "Enter" && !event.shiftKey) { event.preventDefault(); this.enter(); }
    const step = { ArrowUp: 1, ArrowDown: -1 }[event.key], first = this.text.value.slice(0, this.text.selectionStart), rest = this.text.value.slice(this.text.selectionEnd);
    if (!step || (step > 0 ? first : rest).includes("\n")) return; // within several lines the arrows move the cursor
    event.preventDefault();
    this.recall(Math.max(-1, Math.min(this.at + step, this.past.length - 1)));
  }
  recall(at) {
    if (this.at < 0) this.draft = this.text.value;
    this.at = at;
    this.text.value = at < 0 ? this.draft : this.past[at];
    this.history.value = "-1";
    this.fit();
    this.text.focus();
  }

  // One after the other: whoever presses twice executes it once, and nothing that was pressed before a hold begins after it.
  enter() {
    const stays = this.link.stays();
    this.last = this.last.then(() => stays() && this.execute(stays));
  }
  async execute(stays) {
    const text = this.text.value.trimEnd();
    if (!text || !(await this.link.command("set_mdi", { text: `${text}\n` }))) return;
    this.past = [text, ...this.past.filter((each) => each !== text)].slice(0, MOST);
    kept.set("mdi", this.past);
    this.at = -1;
    this.list();
    if (!stays() || !(await this.link.command("cycle_start")) || this.text.value.trimEnd() !== text) return;
    this.text.value = this.draft = "";
    this.fit();
  }
}
