// The scenario: what is to happen to the machine and its doors, how far it is, edited and begun anew.
import { button, make, put, row, table } from "/dom.js";
import { Page } from "/page_base.js";
import { TEXTS } from "/texts.js";
import "/editor.js";

const NAMES = ["name", "do", "with", "for_s", "for_requests", "times", "every_s"]; // all others say when a step begins
const written = (value) => (value && typeof value === "object" ? Object.entries(value).map(([key, each]) => `${key} ${written(each)}`).join(", ") : String(value));
const begins = (step) => Object.entries(step).filter(([key]) => !NAMES.includes(key)).map(([key, value]) => `${key} ${written(value)}`).join(", ");
const ends = (step) => ["for_s", "for_requests", "times", "every_s"].filter((key) => key in step).map((key) => `${key} ${step[key]}`).join(", ");

class ScenarioPage extends Page {
  static every_ms = 500;
  static needs = "control";

  show() {
    if (this.editor) { this.again(); return; }
    this.state = make("p", { class: "row" });
    this.steps = make("div");
    this.past = make("div");
    this.editor = make("cnc-editor", { for: "scenario-text", label: TEXTS.scenario_text });
    this.follow = button("scenario-put", TEXTS.scenario_put, () => this.begin());
    this.follow.disabled = true;
    this.wrong = make("p", { id: "scenario-wrong", role: "status" });
    this.replaceChildren(
      make("p", { class: "row" }, button("scenario-start", TEXTS.scenario_start, () => this.give("start")), button("scenario-stop", TEXTS.scenario_stop, () => this.give("stop")), this.state),
      this.steps, make("h3", {}, TEXTS.happened), this.past, make("h3", {}, TEXTS.scenario_text), make("p", { class: "hint" }, TEXTS.scenario_hint), this.editor,
      make("p", { class: "row after" }, this.follow), this.wrong);
    this.editor.text.readOnly = true; // nothing is typed before what is there
    this.again();
  }

  async give(what) {
    const told = await this.link.json("scenario", { method: "POST", body: JSON.stringify({ do: what }) });
    if (!told) return;
    this.answered();
    this.tell(told);
  }
  async begin() {
    const text = this.editor.value, turn = (this.begun = (this.begun ?? 0) + 1);
    const answer = await fetch(this.link.url("scenario"), { method: "PUT", body: text, headers: { "polycnc-key": this.link.lease.key } }).catch(() => null);
    const told = (await answer?.json().catch(() => null)) ?? { detail: TEXTS.lost, hint: "" };
    if (turn !== this.begun) return; // another text was given meanwhile
    put(this.wrong, answer?.ok ? "" : `${told.detail}\n${told.hint}`);
    const places = (told.errors ?? []).map((each) => /:(\d+):(\d+): (.*)/s.exec(each)).filter(Boolean);
    if (this.editor.value === text) this.editor.show(places.map(([, line, column, said]) => ({ line: Number(line), column: Number(column), text: said })));
    if (!answer?.ok || !told.steps) return;
    this.answered();
    this.tell(told);
  }

  async again() {
    const told = await this.newest("scenario");
    if (!told) return;
    if (this.follow.disabled) {
      this.editor.value = told.source || TEXTS.scenario_example;
      this.editor.text.readOnly = this.follow.disabled = false;
    }
    this.tell(told);
  }
  tell(told) {
    const text = JSON.stringify(told);
    if (!told || text === this.told) return;
    this.told = text;
    put(this.state, told.steps.length ? [told.title, told.running ? `${TEXTS.runs} ${told.time_s.toFixed(1)} s` : TEXTS.ended].filter(Boolean).join(": ") : TEXTS.no_scenario);
    this.querySelector("#scenario-start").disabled = !told.steps.length;
    this.querySelector("#scenario-stop").disabled = !told.running;
    const state = (each) => (each.on ? TEXTS.step_on : each.done ? TEXTS.step_done : TEXTS.step_waits);
    this.steps.replaceChildren(told.steps.length ? table(TEXTS.step_heads, told.steps.map((each) => row(each.step.name, each.step.do, written(each.step.with ?? ""), begins(each.step), ends(each.step), state(each)))) : "");
    this.past.replaceChildren(told.happened.length ? table([TEXTS.cycle, TEXTS.step_heads[0], TEXTS.text], [...told.happened].reverse().map((each) => row(String(each.cycle), each.step, each.what))) : TEXTS.nothing_yet);
  }
}
customElements.define("cnc-page-scenario", ScenarioPage);
