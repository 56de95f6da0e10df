// The program that is executed: its lines, the calls that led to the running one, breakpoints, where a run begins.
import { $, button, make, put, say } from "/dom.js";
import { Held } from "/held.js";
import { TEXTS } from "/texts.js";

const MOST_LINES = 2000, NEAR_PX = 400; // lines that are in the page at once; more come when they are scrolled to
export const OVER = ["ready", "reset", "completed"]; // states in which nothing is executed and nothing goes on
const minutes = (s) => `${Math.floor(s / 60)}:${String(Math.floor(s % 60)).padStart(2, "0")}`;

export class Program {
  constructor(link, changed) {
    Object.assign(this, { link, changed, name: "", lines: [], first: 0, running: 0, chosen: 0, breakpoints: [], selected: "", known: null, turn: 0, before: null, held: new Held(), told: { all: [], number: 0 } });
    this.holder = $("lines");
    $("steps").replaceChildren(
      button("from_line", TEXTS.from_line, () => this.fromLine()), button("breakpoint", TEXTS.breakpoint, () => this.toggleBreakpoint()),
      ...["over", "into", "out"].map((step) => button(`step_${step}`, TEXTS.steps[step], () => link.command("cycle_start", { step }))));
    this.choose(0);
    this.holder.onkeydown = (event) => {
      const step = { ArrowDown: 1, ArrowUp: -1, PageDown: 10, PageUp: -10 }[event.key];
      if (step && !event.altKey) { event.preventDefault(); this.choose(this.chosen + step); }
      if (event.key === " " && this.chosen) { event.preventDefault(); this.toggleBreakpoint(); }
    };
    this.holder.onclick = (event) => { const line = event.target.closest("li"); if (line) this.choose(this.lineOf(line)); };
    this.holder.onscroll = () => this.follow();
  }

  show(status, channel) {
    const { block } = channel, left_s = status.left_s?.[this.link.channel] ?? 0, { timers_s: timers, parts } = status;
    this.selected = channel.program ?? "";
    const calls = (block?.stack ?? []).map((call) => `${call.program}:${call.line}${call.repeat > 1 ? ` ×${call.repeat}` : ""}`);
    put($("name"), [...calls, block?.program ?? channel.program ?? TEXTS.no_program].join(" › "));
    put($("progress"), [block ? `${TEXTS.line} ${block.line} / ${block.lines}` : "", block && !this.lines.length ? block.text : "", timers?.cycle ? `${TEXTS.cycle_time} ${minutes(timers.cycle)}` : "",
      left_s > 0 ? `${TEXTS.left} ${minutes(left_s)}` : "", parts?.made ? `${TEXTS.parts_made} ${parts.made}` : ""].filter(Boolean).join(" · "));
    this.takeBreakpoints();
    const wanted = block && !OVER.includes(channel.run_state) ? block.program : this.selected;
    if (wanted !== this.name) this.load(wanted);
    this.run(block && block.program === this.name ? block.line : 0);
    for (const step of ["over", "into", "out"]) $(`step_${step}`).disabled = !["auto", "mdi"].includes(channel.mode);
  }

  async load(name) {
    const turn = ++this.turn, chosen = name === this.before ? this.chosen : 0; // a line that was chosen stays so where only texts are new
    this.before = this.name = name;
    this.running = 0;
    this.lines = [];
    this.draw(0);
    this.choose(0);
    this.changed(name);
    if (!this.known?.has(name)) return; // blocks put in by hand, or programs that are not in the memory
    const text = await this.link.quietly(`programs/${encodeURIComponent(name)}`);
    if (text === null || turn !== this.turn) return;
    this.lines = text.replace(/\r?\n$/, "").split(/\r?\n/);
    this.draw(0);
    this.run(this.running);
    this.choose(this.chosen || chosen);
  }
  // What is on its way is for a machine that nobody looks at any more.
  close() { this.turn++; }
  // The memory has these programs, some of them changed.
  setPrograms(all) {
    this.known = new Set(all.map((entry) => entry.name));
    this.name = null;
  }

  // Put lines from `first` on into the page.
  draw(first) {
    this.first = Math.max(0, Math.min(first, this.lines.length - MOST_LINES));
    this.holder.start = this.first + 1;
    this.holder.replaceChildren(...this.lines.slice(this.first, this.first + MOST_LINES).map((line) => make("li", {}, line)));
    this.mark(this.running, "aria-current", "step");
    this.mark(this.chosen, "aria-selected", "true");
    this.showBreakpoints();
  }
  lineOf(element) { return this.first + [...this.holder.children].indexOf(element) + 1; }
  at(line) { return this.holder.children[line - 1 - this.first] ?? null; }
  // The element of a line, which is put into the page if it is not there.
  reach(line) {
    if (!this.at(line) && line > 0 && line <= this.lines.length) this.draw(line - MOST_LINES / 2);
    return this.at(line);
  }
  mark(line, name, value) {
    this.holder.querySelector(`[${name}]`)?.removeAttribute(name);
    this.at(line)?.setAttribute(name, value);
  }
  follow() {
    const { scrollTop, clientHeight, scrollHeight } = this.holder, above = scrollTop < NEAR_PX && this.first > 0;
    const below = scrollTop + clientHeight > scrollHeight - NEAR_PX && this.first + MOST_LINES < this.lines.length;
    if (!above && !below) return;
    const [edge] = this.holder.children, anchor = this.lineOf([...this.holder.children].find((line) => line.offsetTop - edge.offsetTop >= scrollTop) ?? edge);
    this.draw(anchor - MOST_LINES / 2);
    this.holder.scrollTop = this.at(anchor).offsetTop - this.holder.firstChild.offsetTop;
  }

  run(line) {
    if (line === this.running && this.holder.querySelector("[aria-current]") === this.at(line)) return;
    this.running = line;
    const now = this.reach(line);
    this.mark(line, "aria-current", "step");
    if (now) this.holder.scrollTop = now.offsetTop - this.holder.offsetTop - this.holder.clientHeight / 2;
  }

  choose(line) {
    this.chosen = Math.max(line && 1, Math.min(line, this.lines.length));
    const found = this.reach(this.chosen);
    this.mark(this.chosen, "aria-selected", "true");
    found?.scrollIntoView({ block: "nearest" });
    $("breakpoint").disabled = !this.chosen;
    $("from_line").disabled = !this.chosen || this.name !== this.selected;
  }
  async fromLine() {
    if (await this.link.command("search", { line: this.chosen, calculate: true })) say(TEXTS.searched);
  }

  // The machine has these; those that were set here stay until it has answered, and what it told before that is older.
  setBreakpoints(all, number) { this.told = { all, number }; this.takeBreakpoints(); }
  takeBreakpoints() {
    const isOlder = this.told.number < this.held.since && this.held.since <= this.link.number; // another process counts anew
    if (this.held.holds || isOlder || this.breakpoints === this.told.all) return;
    this.breakpoints = this.told.all;
    this.showBreakpoints();
  }
  ownBreakpoints() { return this.breakpoints.filter((each) => each.program === this.name && each.channel === this.link.channel).map((each) => each.line); }
  showBreakpoints() {
    const marked = new Set(this.ownBreakpoints());
    [...this.holder.children].forEach((line, k) => line.classList.toggle("breakpoint", marked.has(this.first + k + 1)));
  }
  toggleBreakpoint() {
    const there = this.ownBreakpoints(), line = this.chosen, { name: program } = this, { channel } = this.link;
    const lines = there.includes(line) ? there.filter((each) => each !== line) : [...there, line];
    this.breakpoints = [...this.breakpoints.filter((each) => each.program !== program || each.channel !== channel), ...lines.map((each) => ({ program, channel, line: each }))];
    this.showBreakpoints();
    this.held.send(this.link.given("set_breakpoints", { program, lines }));
  }
}
