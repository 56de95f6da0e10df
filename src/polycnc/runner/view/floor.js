// What helps to read a picture: a grid under the part, program zero with its axes, the axis of a lathe.
import { CanvasTexture, Group, Sprite, SpriteMaterial } from "three";
import { round125 } from "./format.js";
import { polyline } from "./lines.js";
import { css, rgb } from "./theme.js";

const AXES = ["#d14343", "#2f9e5b", "#2f6fd1"];

function text(words, colour, height_mm) {
  const canvas = document.createElement("canvas"), pen = canvas.getContext("2d"), font = "600 44px system-ui, sans-serif";
  pen.font = font;
  canvas.width = Math.ceil(pen.measureText(words).width) + 8; canvas.height = 56;
  pen.font = font; pen.fillStyle = colour; pen.textBaseline = "middle";
  pen.fillText(words, 4, 29);
  const sprite = new Sprite(new SpriteMaterial({ map: new CanvasTexture(canvas), depthTest: false, transparent: true }));
  sprite.scale.set(height_mm * canvas.width / canvas.height, height_mm, 1);
  return sprite;
}

// `box` is what is cut, `names` the axes of the picture, `unit` {factor, name}; `lathe` draws the axis of the spindle.
export function floor(box, names, unit, lathe) {
  const group = new Group(), all = [], sizes = box.map(([low, high]) => high - low), longest = Math.max(...sizes, 1e-3);
  const add = (lines, colour) => { lines.paint(() => rgb(colour)); lines.paper(css("--paper")); group.add(lines.mesh); all.push(lines); };
  const label = (words, colour, at, height) => { const sprite = text(words, colour, height); sprite.position.set(...at); group.add(sprite); };
  const big = 0.045 * longest, step = round125(longest * unit.factor / 8) / unit.factor;
  const up = lathe ? 1 : 2, [p, q] = lathe ? [0, 2] : [0, 1];
  const from = [p, q].map((i) => Math.floor((box[i][0] - 0.06 * longest) / step) * step), to = [p, q].map((i) => Math.ceil((box[i][1] + 0.06 * longest) / step) * step);
  const level = lathe ? 0.01 * longest : Math.min(box[2][0], 0) - 0.002 * longest;
  const place = (a, b) => { const at = [0, 0, 0]; at[p] = a; at[q] = b; at[up] = level; return at; };
  const grid = [];
  for (let a = from[0]; a <= to[0] + 1e-9; a += step) grid.push(place(a, from[1]), place(a, to[1]), null);
  for (let b = from[1]; b <= to[1] + 1e-9; b += step) grid.push(place(from[0], b), place(to[0], b), null);
  add(polyline(grid, { width: 1, order: -2 }), css("--grid"));
  const number = (mm) => String(Number((mm * unit.factor).toFixed(4)));
  for (let a = from[0]; a <= to[0] + 1e-9; a += step) label(number(a), css("--soft"), place(a, from[1] - 0.7 * big), 0.62 * big);
  for (let b = from[1]; b <= to[1] + 1e-9; b += step) label(number(lathe?.diameters ? 2 * Math.abs(b) : lathe ? Math.abs(b) : b), css("--soft"), place(from[0] - 1.1 * big, b), 0.62 * big);
  const arrow = 0.13 * longest;
  (lathe ? [[0, names[2]], [2, names[0]]] : [[0, names[0]], [1, names[1]], [2, names[2]]]).forEach(([i, name]) => {
    if (!name) return;
    const tip = [0, 0, 0]; tip[i] = arrow;
    const colour = AXES[lathe ? (i === 0 ? 2 : 0) : i];
    add(polyline([[0, 0, 0], tip], { width: 2.5, order: 3 }), colour);
    tip[i] = 1.25 * arrow;
    label(name, colour, tip, big);
  });
  if (lathe) {
    const dash = [];
    for (let a = from[0]; a < to[0]; a += 0.05 * longest) dash.push([a, 0, 0], [a + 0.035 * longest, 0, 0], null);
    add(polyline(dash, { width: 1.5, order: 3 }), css("--soft"));
  }
  return { group, lines: all, reach: longest };
}
