// Alarms with what to do, messages, snapshots to go back to, and who is connected.
import { button, make, row, table } from "/dom.js";
import { Page } from "/page_base.js";
import { TEXTS } from "/texts.js";

const MOST_SHOWN = 20;
const numbered = (alarm) => (alarm.number < 0 ? "" : String(alarm.number));

class Alarms extends Page {
  static follows = ["alarms", "messages"];
  static needs = "control";
  static every_ms = 500;
  show() { this.shown = null; this.again(); }
  again() {
    const { alarms = [], messages = [] } = this.link.status ?? {}, told = JSON.stringify([alarms, messages, this.parts.alarms, this.parts.messages]);
    if (told === this.shown) return;
    this.shown = told;
    const newest = (part) => [...(this.parts[part] ?? [])].reverse();
    const rows = [
      ...alarms.map((each) => row(numbered(each), each.text, TEXTS.cleared[each.cleared_by] ?? "", TEXTS.now)),
      ...messages.map((each) => row(numbered(each), each.text, TEXTS.message, TEXTS.now)),
      ...newest("alarms").map((each) => row(numbered(each), each.text, TEXTS.cleared[each.cleared_by] ?? "", each.time ?? "")),
      ...newest("messages").map((each) => row(numbered(each), each.text, TEXTS.message, each.time ?? "")),
    ];
    this.replaceChildren(rows.length ? table([TEXTS.number, TEXTS.text, TEXTS.to_do, TEXTS.time], rows) : make("p", {}, TEXTS.no_alarms),
      button("clear-alarms", TEXTS.forget_all, () => this.link.command("clear_alarm_history")));
  }
}
customElements.define("cnc-page-alarms", Alarms);

class Snapshots extends Page {
  show() {
    if (!this.list) {
      const name = make("input", { id: "snapshot-name", value: "snapshot", maxlength: "64", "aria-label": TEXTS.name });
      this.list = make("div");
      this.replaceChildren(make("p", { class: "row" }, make("label", {}, TEXTS.name, " ", name), button("keep", TEXTS.keep, () => this.give("POST", "snapshot", { name: name.value }))),
        make("p", { class: "hint" }, TEXTS.snapshot_hint), this.list);
    }
    this.again();
  }
  async give(method, rest, body) { if (await this.send(method, rest, body)) this.again(); }
  async again() {
    const all = await this.newest("snapshots");
    if (!all) return;
    const rows = all.map((each) => row(each.name, String(each.cycle),
      button(`restore-${each.name}`, TEXTS.restore, () => this.give("POST", "restore", { name: each.name })),
      button(`forget-${each.name}`, TEXTS.forget, () => this.give("DELETE", `snapshots/${encodeURIComponent(each.name)}`))));
    this.list.replaceChildren(rows.length ? table([TEXTS.name, TEXTS.cycle, "", ""], rows) : "");
  }
}
customElements.define("cnc-page-snapshots", Snapshots);

class Connections extends Page {
  static every_ms = 1000;
  show() {
    const { lease } = this.link, name = make("input", { id: "operator", value: lease.operator, maxlength: "40", "aria-label": TEXTS.your_name });
    name.addEventListener("change", () => { lease.operator = name.value; if (lease.mine) lease.hold(true); });
    this.doors = make("div");
    this.replaceChildren(make("label", {}, TEXTS.your_name, " ", name), this.doors);
    this.again();
  }
  async again() {
    const all = await this.newest("connections");
    if (!all) return;
    this.doors.replaceChildren(table([TEXTS.door, TEXTS.address, TEXTS.number, TEXTS.clients],
      all.map((each) => row(each.door, each.address, String(each.clients.length), each.clients.slice(0, MOST_SHOWN).join(", ")))));
  }
}
customElements.define("cnc-page-connections", Connections);
