// What only some machines have: the screen of a program with its keys, and tasks that run beside the axes.
import { button, make, row, table } from "/dom.js";
import { Page } from "/page_base.js";
import { TEXTS } from "/texts.js";

const KEYS_OF = { Enter: "ENTER", Delete: "DELETE", Backspace: "DELETE", ArrowUp: "CURSOR_UP", ArrowDown: "CURSOR_DOWN", ArrowLeft: "CURSOR_LEFT", ArrowRight: "CURSOR_RIGHT", Escape: "LEVEL_RETURN",
  ...Object.fromEntries([1, 2, 3, 4, 5, 6, 7, 8].map((k) => [`F${k}`, `SOFTKEY${k}`])) };

class Screen extends Page {
  static needs = "screen";
  static every_ms = 500;
  show() {
    this.picture = make("img", { id: "screen", alt: TEXTS.pages.screen, tabindex: "0" });
    this.picture.addEventListener("keydown", (event) => {
      const name = KEYS_OF[event.key] ?? (event.key.length === 1 ? event.key : null);
      if (name && !event.altKey && !event.ctrlKey && !event.metaKey) { event.preventDefault(); event.stopPropagation(); this.press(name); }
    });
    this.keys = make("p", { class: "row", id: "screen-keys" });
    this.replaceChildren(this.picture, this.keys, make("p", { class: "hint" }, TEXTS.screen_hint));
    this.again();
  }
  async press(key) { if (await this.send("POST", "screen", { key })) this.again(); }
  async again() {
    const told = await this.newest("screen"), text = JSON.stringify(told);
    if (!told || (this.keys.dataset.told === text && this.picture.src)) return;
    this.keys.dataset.told = text;
    this.picture.src = `${this.link.url("screen.svg")}?at=${performance.now()}`;
    this.picture.alt = told.lines.map((line) => line.trimEnd()).filter(Boolean).join("\n");
    const soft = told.softkeys.map((label, k) => button(`key-SOFTKEY${k + 1}`, label.replaceAll("&", " ") || `F${k + 1}`, () => this.press(`SOFTKEY${k + 1}`)));
    const names = told.keys.filter((key) => !key.startsWith("SOFTKEY"));
    this.keys.replaceChildren(...soft, ...names.map((key) => button(`key-${key}`, TEXTS.keys_of_screen[key] ?? key, () => this.press(key))));
  }
}
customElements.define("cnc-page-screen", Screen);

class Tasks extends Page {
  static needs = "tasks";
  static every_ms = 500;
  show() {
    const source = make("textarea", { id: "source", "aria-label": TEXTS.source, spellcheck: "false", placeholder: TEXTS.source });
    const task = make("select", { id: "task", "aria-label": TEXTS.task }, ...[0, 1, 2, 3].map((number) => make("option", {}, String(number))));
    this.list = make("div");
    const load = async () => { if (await this.send("PUT", `tasks/${task.value}`, source.value)) this.again(); };
    this.replaceChildren(this.list, make("p", { class: "row" }, task, button("load-task", TEXTS.load, load)), source);
    this.again();
  }
  async again() {
    if (this.list.contains(document.activeElement)) return;
    const all = await this.newest("tasks");
    if (!all || this.list.contains(document.activeElement)) return; // a key that is being pressed stays
    const give = (number, what) => button(`${what}-${number}`, TEXTS.tasks_do[what], async (event) => {
      event.target.blur();
      if (await this.send("POST", `tasks/${number}`, { do: what })) this.again();
    });
    const rows = all.map((each) => row(String(each.task), each.state, each.line ? String(each.line) : "",
      each.error_number ? `${each.error_number} ${each.error} (${TEXTS.line} ${each.error_line})` : "", give(each.task, "start"), give(each.task, "stop"), give(each.task, "continue")));
    this.list.replaceChildren(table([TEXTS.task, TEXTS.state, TEXTS.line, TEXTS.error_of, "", "", ""], rows));
  }
}
customElements.define("cnc-page-tasks", Tasks);
