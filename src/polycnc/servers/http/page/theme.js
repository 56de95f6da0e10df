// Dark, light, or as the system has it; whoever draws by itself listens to `theme` of the document.
import { kept } from "/dom.js";

export const THEMES = ["system", "light", "dark"];
export const theme = () => kept.get("theme", THEMES[0]);
const changed = () => document.dispatchEvent(new Event("theme"));

export function wear(name) {
  document.documentElement.style.colorScheme = name === "system" ? "light dark" : name;
  kept.set("theme", name);
  changed();
}
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);
