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
  constructor(link) {
    this.link = link;
    this.key = ownKey();
    this.holder = null;
    this.held = sessionStorage.getItem("held") ?? ""; // the machine and the turn of the lease that was taken here
    Object.assign(this, { asking: 0, wish: 0, last: Promise.resolve() });
    this.button = document.createElement("button");
    this.button.id = "lease";
    this.button.onclick = () => (this.mine ? this.release() : this.hold(true));
  }
  get operator() { return localStorage.getItem("operator") || TEXTS.operator; }
  set operator(name) { localStorage.setItem("operator", name.trim().slice(0, 40)); }

  // One request at a time, to the machine of the press; its answer counts unless another wish came, or another machine was chosen.
  async ask(options, then) {
    const of = this.link.name, at = this.link.url("lease"), { wish } = this;
    this.asking++;
    this.last = this.last.then(() => this.link.ask("lease", options, at));
    const answer = await this.last, told = options.body && answer && (await answer.json().catch(() => null));
    this.asking--;
    if (answer !== undefined && wish === this.wish && this.link.name === of) then?.(told, Number(answer?.headers.get("polycnc-number")));
  }
  hold(take) {
    if (take) this.wish++;
    return this.ask({ method: "POST", body: JSON.stringify({ operator: this.operator, key: this.key, seconds: KEEP_S, take }) }, (told, number) => {
      this.own(told ? this.named(told) : "");
      if (told && !this.link.isLate(number)) this.show(told);
    });
  }
  release() {
    this.wish++;
    this.own("");
    return this.ask({ method: "DELETE" });
  }
  own(held) { this.held = held; sessionStorage.setItem("held", held); }
  named(told) { return `${this.link.name}/${told.turn}`; }
  get mine() { return Boolean(this.held); }

  // What the stream tells of the lease.
  show(told) {
    const isMine = Boolean(told.holder) && this.named(told) === this.held;
    if (this.asking) return; // what is answered comes after it
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
