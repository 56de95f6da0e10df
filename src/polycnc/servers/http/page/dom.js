// Elements of the page: found, made, filled.
export const $ = (id) => document.getElementById(id);

export function make(tag, attributes = {}, ...inside) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value); else made.setAttribute(name, value);
  }
  made.append(...inside);
  return made;
}

export const button = (id, text, action) => make("button", { id, onclick: action }, text);
export const put = (place, text) => { if (place.textContent !== text) place.textContent = text; };
export const isPressed = (element) => element.getAttribute("aria-pressed") === "true";
export const toggle = (id, text, turned) => make("button", { id, "aria-pressed": "false",
  onclick: ({ currentTarget }) => { currentTarget.setAttribute("aria-pressed", !isPressed(currentTarget)); turned?.(isPressed(currentTarget)); } }, text);

export const row = (head, ...cells) => make("tr", {}, make("th", { scope: "row" }, head), ...cells.map((cell) => make("td", {}, cell ?? "")));
export const table = (heads, rows) => make("div", { class: "wide", tabindex: "0" },
  make("table", {}, make("tr", {}, ...heads.map((head) => make("th", { scope: "col" }, head))), ...rows));

const SHOWN_MS = 6000;
export function say(text) {
  put($("said"), text);
  clearTimeout(say.timer);
  say.timer = setTimeout(() => put($("said"), ""), SHOWN_MS);
}

// What this browser remembers between visits; where it may not, nothing.
export const kept = {
  get(name, otherwise) { try { return JSON.parse(localStorage.getItem(name)) ?? otherwise; } catch { return otherwise; } },
  set(name, value) { try { localStorage.setItem(name, JSON.stringify(value)); } catch { /* it is for this visit then */ } },
};
