// A handwheel: an axis is chosen, and turning it by mouse, finger or keys sends pulses.
import { make } from "/dom.js";
import { TEXTS } from "/texts.js";

const PULSES = 100, SEND_MS = 100, MOST_PENDING = 1000;
const KEYS = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1, PageUp: 10, PageDown: -10 };

export class HandWheel extends HTMLElement {
  constructor(axes, size, send) {
    super();
    Object.assign(this, { axes, size, send, axis: axes[0], at: 0, pending: 0, sending: false });
  }

  connectedCallback() {
    if (this.disc) return;
    this.disc = make("div", { id: "wheel", role: "spinbutton", tabindex: "0", "aria-label": TEXTS.wheel, "aria-valuenow": "0" }, make("i", {}));
    this.choices = this.axes.map((axis) => make("button", { "aria-pressed": "false", onclick: () => this.choose(axis) }, axis));
    this.replaceChildren(this.disc, make("div", { role: "group", "aria-label": TEXTS.wheel_axis, class: "row" }, ...this.choices), make("p", { class: "hint" }, TEXTS.wheel_hint));
    this.choose(this.axis);
    this.disc.addEventListener("wheel", (event) => { event.preventDefault(); this.turn(event.deltaY < 0 ? 1 : -1); }, { passive: false });
    this.disc.addEventListener("keydown", (event) => {
      if (!KEYS[event.key] || event.altKey) return;
      event.preventDefault();
      event.stopPropagation();
      this.turn(KEYS[event.key]);
    });
    this.disc.addEventListener("pointerdown", (event) => { this.disc.setPointerCapture(event.pointerId); this.grip = this.angle(event); });
    this.disc.addEventListener("pointermove", (event) => this.drag(event));
    for (const end of ["pointerup", "pointercancel"]) this.disc.addEventListener(end, () => { this.grip = null; });
  }

  choose(axis) {
    this.forget();
    this.axis = axis;
    for (const each of this.choices) each.setAttribute("aria-pressed", each.textContent === axis);
  }

  angle(event) {
    const box = this.disc.getBoundingClientRect();
    return Math.atan2(event.clientY - (box.top + box.bottom) / 2, event.clientX - (box.left + box.right) / 2) / (2 * Math.PI);
  }
  drag(event) {
    if (this.grip === null || this.grip === undefined) return;
    const now = this.angle(event), part = ((now - this.grip + 1.5) % 1) - 0.5, pulses = Math.trunc(part * PULSES);
    if (!pulses) return;
    this.grip += pulses / PULSES;
    this.turn(pulses);
  }

  turn(pulses, axis = this.axis) {
    if (axis !== this.axis) this.choose(axis);
    this.at += pulses;
    this.pending = Math.max(-MOST_PENDING, Math.min(this.pending + pulses, MOST_PENDING));
    this.disc.firstChild.style.transform = `rotate(${this.at * 360 / PULSES}deg)`;
    this.disc.setAttribute("aria-valuenow", this.at);
    if (!this.sending) this.flush();
  }

  // One command at a time, with all pulses since the last one.
  async flush() {
    this.sending = true;
    while (this.pending) {
      const pulses = this.pending;
      this.pending = 0;
      if (!(await this.send({ axis: this.axis, pulses, size: this.size() }))) this.pending = 0;
      await new Promise((done) => setTimeout(done, SEND_MS));
    }
    this.sending = false;
  }
  forget() { this.pending = 0; this.grip = null; }
}
customElements.define("cnc-wheel", HandWheel);
