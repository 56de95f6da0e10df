// Colours: told apart without red and green (after Okabe and Ito), and one scale from slow to fast.
const PALETTE = {
  light: ["#0072b2", "#d55e00", "#009e73", "#a8488a", "#8a6d00", "#3a3f45", "#4fa3d9"],
  dark: ["#56b4e9", "#e69f00", "#2fc79a", "#e07fb5", "#f0e442", "#c9d1d8", "#ff8a50"],
};
const SCALE = { light: ["#3b2f8f", "#2c6fbb", "#12a38a", "#7fc241", "#f2b705"], dark: ["#5d6fd0", "#21a8c0", "#2fd39a", "#b5de2b", "#fde725"] };

const root = document.documentElement;

export function begin() {
  root.dataset.theme = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
}

export function turnOver() {
  root.dataset.theme = root.dataset.theme === "dark" ? "light" : "dark";
}

export const css = (name) => getComputedStyle(root).getPropertyValue(name).trim();

export const paletteColour = (i) => { const all = PALETTE[root.dataset.theme]; return all[i % all.length]; };

export const scaleColours = () => SCALE[root.dataset.theme];

export const rgb = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));

// A colour of the scale as r, g, b (0 to 255), for a share from 0 to 1.
export function scaled(share) {
  const colours = scaleColours(), at = Math.min(Math.max(share, 0), 1) * (colours.length - 1);
  const low = Math.min(Math.floor(at), colours.length - 2), part = at - low;
  const from = rgb(colours[low]), to = rgb(colours[low + 1]);
  return from.map((value, i) => value + part * (to[i] - value));
}
