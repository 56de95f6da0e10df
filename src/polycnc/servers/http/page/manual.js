// Axes moved by hand: jog keys that are held, increments, the handwheel, the reference.
import { $, button, isPressed, make, toggle } from "/dom.js";
import { TEXTS } from "/texts.js";
import { HandWheel } from "/wheel.js";

const BEAT_MS = 200, SIZES = [0.001, 0.01, 0.1, 1, 10], USUAL_SIZE = 0.1;
const KEYS = { ArrowRight: [0, 1], ArrowLeft: [0, -1], ArrowUp: [1, 1], ArrowDown: [1, -1], PageUp: [2, 1], PageDown: [2, -1] };
const TEXT = "input, textarea, select, ol, summary, [role=tab], [role=spinbutton]";

// The axes of the arrows left and right, up and down, and of the page keys.
export function axesOfKeys(axes) {
  if (axes.includes("X") && axes.includes("Z") && !axes.includes("Y")) return ["Z", "X", axes.find((name) => !["X", "Z"].includes(name))]; // a lathe
  return ["X", "Y", "Z"].every((name) => axes.includes(name)) ? ["X", "Y", "Z"] : axes.slice(0, 3);
}

export class Manual {
  constructor(link, place, axes) {
    Object.assign(this, { link, held: new Map(), keys: axesOfKeys(axes) });
    this.rapidly = toggle("rapidly", TEXTS.rapidly);
    this.size = make("select", { id: "size", "aria-label": TEXTS.increment }, ...SIZES.map((value) => make("option", {}, String(value))));
    this.size.value = String(USUAL_SIZE);
    this.wheel = new HandWheel(axes, () => Number(this.size.value), (values) => link.command("handwheel", values));
    place.replaceChildren(...axes.flatMap((axis) => [1, -1].map((direction) => this.key(axis, direction))), this.rapidly,
      make("label", {}, TEXTS.increment, " ", this.size),
      button("zero", TEXTS.zero, () => { for (const axis of axes) link.command("set_relative", { axis }); }), this.wheel);
  }

  key(axis, direction) {
    const press = () => this.press(axis, direction), release = () => this.release(axis);
    const made = make("button", { "data-jog": axis, "data-way": direction, onpointerdown: press, onpointerup: release, onpointerleave: release, onpointercancel: release, onblur: release },
      `${axis}${direction > 0 ? "+" : "−"}`);
    made.addEventListener("contextmenu", (event) => event.preventDefault()); // a long press on a touch screen
    made.addEventListener("keydown", (event) => {
      if (![" ", "Enter"].includes(event.key) || event.altKey) return;
      event.preventDefault();
      if (!event.repeat) press();
    });
    made.addEventListener("keyup", (event) => { if ([" ", "Enter"].includes(event.key)) release(); });
    return made;
  }

  show(mode) {
    for (const key of document.querySelectorAll("[data-jog]")) key.disabled = !["jog", "inc", "ref"].includes(mode) || (mode === "ref" && key.dataset.way === "-1");
    this.rapidly.hidden = !["jog", "inc"].includes(mode);
    this.size.parentElement.hidden = !["inc", "handle"].includes(mode);
    this.wheel.hidden = mode !== "handle";
    this.wheel.parentElement.classList.toggle("wheeled", mode === "handle");
    if (mode !== this.mode && this.mode !== undefined) this.releaseAll();
    this.mode = mode;
  }

  press(axis, direction, fast = false) {
    const rapid = fast || isPressed(this.rapidly), size = Number(this.size.value);
    if (this.mode === "inc") this.link.command("increment", { axis, direction, size, rapid });
    if (this.mode === "ref") this.link.command("reference", { axis });
    if (this.mode === "handle") this.wheel.turn(direction, axis);
    if (this.mode !== "jog" || this.held.has(axis)) return;
    this.link.jog(axis, direction, rapid);
    this.held.set(axis, setInterval(() => this.link.jog(axis, direction, rapid, true), BEAT_MS)); // a key that is not repeated is released by the machine
  }
  release(axis) {
    if (!this.held.has(axis)) return;
    clearInterval(this.held.get(axis));
    this.held.delete(axis);
    this.link.jog(axis, 0);
  }
  releaseAll() {
    for (const axis of [...this.held.keys()]) this.release(axis);
    this.wheel.forget();
  }

  // A key of the keyboard went down or up; whether it was one of these.
  keyDown(event) {
    const [k, direction] = KEYS[event.key] ?? [], axis = this.keys[k];
    if (!axis || event.altKey || event.target.matches(TEXT) || !["jog", "inc", "handle"].includes(this.mode)) return;
    event.preventDefault();
    if (!event.repeat || this.mode === "handle") this.press(axis, direction, event.shiftKey);
  }
  keyUp(event) { if (KEYS[event.key] && this.keys[KEYS[event.key][0]]) this.release(this.keys[KEYS[event.key][0]]); }
}
