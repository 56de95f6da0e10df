// Who commands: this page alone, somebody else, or everybody.
import { TEXTS } from "/texts.js";

const KEEP_S = 10, RENEW_S = 5;

function ownKey() {
  const kept = sessionStorage.getItem("key");
  if (kept) return kept;
  const key = [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, "0")).join("");
  sessionStorage.setItem("key", key);
  return key;
}

export class Lease {
  constructor(ask) {
    this.ask = ask;
    this.key = ownKey();
    this.holder = null;
    this.mine = sessionStorage.getItem("mine") === "yes";
    this.button = document.createElement("button");
    this.button.id = "lease";
    this.button.onclick = () => (this.mine ? this.release() : this.hold(true));
  }
  get operator() { return localStorage.getItem("operator") || TEXTS.operator; }
  set operator(name) { localStorage.setItem("operator", name.trim().slice(0, 40)); }

  async hold(take) {
    this.asking = true;
    const body = JSON.stringify({ operator: this.operator, key: this.key, seconds: KEEP_S, take });
    const answer = await this.ask("lease", { method: "POST", body });
    this.asking = false;
    this.own(Boolean(answer));
    if (answer) this.show(await answer.json());
  }
  async release() {
    this.own(false);
    await this.ask("lease", { method: "DELETE" });
  }
  own(mine) { this.mine = mine; sessionStorage.setItem("mine", mine ? "yes" : "no"); }

  // What the stream tells of the lease.
  show(told) {
    if (this.asking) return;
    this.holder = told.holder;
    if (told.holder !== this.operator) this.own(false);
    if (this.mine && told.left_s < RENEW_S) this.hold(false);
    const other = Boolean(told.holder) && !this.mine;
    document.body.classList.toggle("watching", other);
    const text = other ? `${told.holder} ${TEXTS.commands}: ${TEXTS.take_over}` : this.mine ? TEXTS.give_back : TEXTS.hold;
    if (this.button.textContent !== text) this.button.textContent = text;
    this.button.setAttribute("aria-pressed", String(this.mine));
  }
}
