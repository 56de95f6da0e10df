// Which of several channels is shown, which switches are on, and which blocks block delete skips.
import { Held } from "/held.js";
import { $, isPressed, kept, make, put, toggle } from "/dom.js";
import { TEXTS } from "/texts.js";

const SWITCHES = ["single_block", "dry_run", "optional_stop", "machine_lock"];
const MARKS = [1, 2, 3, 4, 5, 6, 7, 8, 9];

// The choice of a channel: it is there where a machine has several, and says what each of them does.
export function channelChoice(link, chosen) {
  const select = make("select", { id: "channel", "aria-label": TEXTS.channel_choice, title: TEXTS.channel_choice, hidden: "", onchange: () => chosen(Number(select.value)) });
  const show = ({ channels }) => {
    select.hidden = channels.length < 2;
    if (select.hidden) return;
    if (select.length !== channels.length) select.replaceChildren(...channels.map((_, k) => make("option", { value: String(k) })));
    channels.forEach((each, k) => put(select.options[k], `${k + 1}: ${each.axes.join(" ")} · ${each.run_state.replaceAll("_", " ")}`));
    if (document.activeElement !== select) select.value = String(link.channel);
  };
  return { select, show };
}

// The switches of a channel; each shows what it was turned to until the machine has answered.
export class Switches {
  constructor(link) {
    this.held = Object.fromEntries(SWITCHES.map((name) => [name, new Held()]));
    this.elements = SWITCHES.map((name) => toggle(name, TEXTS[name], (on) => this.held[name].send(link.given("set_switches", { [name]: on }))));
  }
  show(switches) {
    for (const name of SWITCHES) if (!this.held[name].holds) $(name).setAttribute("aria-pressed", switches[name]);
  }
}

// Block delete: on or off, and the marks (/1 to /9, a slash alone is /1) that it skips while it is on.
export class Marks {
  constructor(link) {
    this.chosen = new Set(kept.get("marks", [1]));
    this.held = new Held();
    const turn = () => {
      const marks = isPressed(this.key) ? [...this.chosen] : [];
      this.held.send(link.given("set_switches", { block_delete: marks }));
    };
    this.key = toggle("block_delete", TEXTS.block_delete, turn);
    this.head = make("summary", { "aria-label": TEXTS.marks, title: TEXTS.marks });
    this.each = MARKS.map((mark) => toggle(`mark_${mark}`, `/${mark}`, (on) => {
      if (on) this.chosen.add(mark); else if (this.chosen.size > 1) this.chosen.delete(mark);
      kept.set("marks", [...this.chosen]);
      this.tell();
      if (isPressed(this.key)) turn();
    }));
    this.elements = [this.key, make("details", { id: "marks" }, this.head, make("div", { class: "row" }, ...this.each))];
    this.tell();
  }
  // These are skipped now.
  show(marks) {
    if (this.held.holds) return;
    this.key.setAttribute("aria-pressed", marks.length > 0);
    if (marks.length && marks.join() !== [...this.chosen].join()) { this.chosen = new Set(marks); this.tell(); }
  }
  tell() {
    put(this.head, [...this.chosen].sort().map((mark) => `/${mark}`).join(" "));
    this.each.forEach((key, k) => key.setAttribute("aria-pressed", this.chosen.has(MARKS[k])));
  }
}
