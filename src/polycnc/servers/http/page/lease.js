// Who commands: this page alone, somebody else, or everybody.
import { TEXTS } from "/texts.js";

const KEEP_S = 10, RENEW_S = 5, LATE_MS = 1000;

function ownKey() {
  const kept = sessionStorage.getItem("key");
  if (kept) return kept;
  const key = [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, "0")).join("");
  sessionStorage.setItem("key", key);
  return key;
}

export class Lease {
  constructor(link) {
    this.link = link;
    this.key = ownKey();
    this.holder = null;
    this.held = sessionStorage.getItem("held") ?? ""; // the machine and the turn of the lease that was taken here
    this.since = -Infinity;
    this.button = document.createElement("button");
    this.button.id = "lease";
    this.button.onclick = () => (this.mine ? this.release() : this.hold(true));
  }
  get operator() { return localStorage.getItem("operator") || TEXTS.operator; }
  set operator(name) { localStorage.setItem("operator", name.trim().slice(0, 40)); }

  async hold(take) {
    this.asking = true;
    const body = JSON.stringify({ operator: this.operator, key: this.key, seconds: KEEP_S, take });
    const told = await this.link.json("lease", { method: "POST", body });
    this.asking = false;
    this.own(told ? this.named(told) : "");
    this.since = performance.now();
    if (told) this.show(told);
  }
  async release() {
    this.own("");
    await this.link.ask("lease", { method: "DELETE" });
  }
  own(held) { this.held = held; sessionStorage.setItem("held", held); }
  named(told) { return `${this.link.name}/${told.turn}`; }
  get mine() { return Boolean(this.held); }

  // What the stream tells of the lease.
  show(told) {
    const isMine = Boolean(told.holder) && this.named(told) === this.held;
    if (this.asking || (!isMine && performance.now() - this.since < LATE_MS)) return; // told before it was taken here
    this.holder = told.holder;
    if (!isMine) this.own("");
    if (this.mine && told.left_s < RENEW_S) this.hold(false);
    const other = Boolean(told.holder) && !this.mine;
    document.body.classList.toggle("watching", other);
    const text = other ? `${told.holder} ${TEXTS.commands}: ${TEXTS.take_over}` : this.mine ? TEXTS.give_back : TEXTS.hold;
    if (this.button.textContent !== text) this.button.textContent = text;
    this.button.setAttribute("aria-pressed", String(this.mine));
  }
}
