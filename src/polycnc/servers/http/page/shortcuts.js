// The keys that work everywhere on the page, as a table: what the list shows, and what is pressed or focused.
import { $, make } from "/dom.js";
import { TEXTS } from "/texts.js";

export const SHORTCUTS = [
  { keys: "Alt+X", press: "stop", only: "false" }, // presses only: whoever presses twice does not release it
  { keys: "Alt+S", press: "cycle_start" },
  { keys: "Alt+H", press: "feed_hold" },
  { keys: "Alt+R", press: "reset" },
  { keys: "Alt+N", press: "step_over" },
  { keys: "Alt+B", press: "single_block" },
  { keys: "Alt+M", focus: "mdi" },
  { keys: "Alt+L", focus: "lines" },
  { keys: "Alt+0", press: "tab-run" },
  { keys: "Alt+P", press: "tab-programs" },
  { keys: "Alt+T", press: "tab-tools" },
  { keys: "Alt+O", press: "tab-offsets" },
  { keys: "Alt+A", press: "tab-alarms" },
  { keys: "Alt+F", press: "far" },
  { keys: "?", press: "help" },
];
const BY_HAND = ["arrows", "pages", "shift", "space", "wheel", "mdi_history", "mdi_lines"]; // what other modules do with keys

const code = (keys) => { const last = keys.at(-1); return /\d/.test(last) ? `Digit${last}` : `Key${last}`; };
const isText = (element) => element.matches("input:not([type=range]), textarea, select");

export function follow(event) {
  const found = SHORTCUTS.find(({ keys }) => (keys === "?" ? event.key === "?" && !isText(event.target) : event.altKey && !event.ctrlKey && event.code === code(keys)));
  const element = found && $(found.press ?? found.focus);
  if (!element || element.closest("[inert]")) return false;
  event.preventDefault();
  if (found.focus) element.focus();
  else if (!found.only || element.getAttribute("aria-pressed") === found.only) element.click();
  return true;
}

// The list of the keys, as a dialog that its button opens.
export function shortcutList() {
  const line = (keys, text) => make("tr", {}, make("th", { scope: "row" }, make("kbd", {}, keys)), make("td", {}, text));
  const dialog = make("dialog", { id: "shortcuts", "aria-label": TEXTS.shortcuts },
    make("form", { method: "dialog", class: "row" }, make("h2", {}, TEXTS.shortcuts), make("button", { autofocus: "" }, TEXTS.close)),
    make("table", {}, ...SHORTCUTS.map(({ keys, press, focus }) => line(keys, TEXTS.does[press ?? focus])), ...BY_HAND.map((name) => line(...TEXTS.by_hand[name]))));
  dialog.addEventListener("keydown", (event) => { if (event.key === "Escape") dialog.close(); });
  return dialog;
}
