// What helps to read a picture: a grid under the part, program zero with its axes, the axis of a lathe.
import { CanvasTexture, Group, Sprite, SpriteMaterial, SRGBColorSpace, Vector3 } from "three";
import { round125 } from "./format.js";
import { polyline } from "./lines.js";
import { css, rgb } from "./theme.js";

const AXES = ["#d14343", "#2f9e5b", "#2f6fd1"];

function text(words, colour, height_px) {
  const canvas = document.createElement("canvas"), pen = canvas.getContext("2d"), font = "600 44px system-ui, sans-serif";
  pen.font = font;
  canvas.width = Math.ceil(pen.measureText(words).width) + 8; canvas.height = 56;
  pen.font = font; pen.fillStyle = colour; pen.textBaseline = "middle";
  pen.fillText(words, 4, 29);
  const map = Object.assign(new CanvasTexture(canvas), { colorSpace: SRGBColorSpace });
  const sprite = new Sprite(new SpriteMaterial({ map, depthTest: false, transparent: true }));
  sprite.renderOrder = 8;
  return Object.assign(sprite, { size_px: [height_px * canvas.width / canvas.height, height_px] });
}

// `box` is what is cut, `names` the axes of the picture, `unit` {factor, name}; `lathe` draws the axis of the spindle.
export function floor(box, names, unit, lathe) {
  const group = new Group(), all = [], labels = [], numbers = [], sizes = box.map(([low, high]) => high - low), longest = Math.max(...sizes, 1e-3);
  const add = (lines, colour) => { lines.paint(() => rgb(colour)); lines.paper(css("--paper")); group.add(lines.mesh); all.push(lines); return lines; };
  const through = (lines) => { lines.material.depthTest = false; }; // seen through the part, as its letters are
  const label = (words, colour, at, height) => { const sprite = text(words, colour, height); sprite.position.set(...at); group.add(sprite); labels.push(sprite); return sprite; };
  const big = 0.045 * longest, step = round125(longest * unit.factor / 8) / unit.factor;
  const up = lathe ? 1 : 2, [p, q] = lathe ? [0, 2] : [0, 1];
  const from = [p, q].map((i) => Math.floor((box[i][0] - 0.06 * longest) / step) * step), to = [p, q].map((i) => Math.ceil((box[i][1] + 0.06 * longest) / step) * step);
  const level = lathe ? box[1][1] + 0.01 * longest : Math.min(box[2][0], 0) - 0.012 * longest;
  const place = (a, b) => { const at = [0, 0, 0]; at[p] = a; at[q] = b; at[up] = level; return at; };
  const grid = [];
  for (let a = from[0]; a <= to[0] + 1e-9; a += step) grid.push(place(a, from[1]), place(a, to[1]), null);
  for (let b = from[1]; b <= to[1] + 1e-9; b += step) grid.push(place(from[0], b), place(to[0], b), null);
  add(polyline(grid, { width: 1, order: -2 }), css("--grid"));
  const number = (mm) => String(Number((mm * unit.factor).toFixed(4)));
  for (let a = from[0]; a <= to[0] + 1e-9; a += step) numbers.push(Object.assign(label(number(a), css("--soft"), place(a, from[1] - 0.7 * big), 14), { value: a }));
  for (let b = from[1] + step; b <= to[1] + 1e-9; b += step) numbers.push(Object.assign(label(number(lathe?.diameters ? 2 * Math.abs(b) : lathe ? Math.abs(b) : b), css("--soft"), place(from[0] - 1.1 * big, b), 14), { value: b }));
  const arrow = 0.13 * longest;
  (lathe ? [[0, names[2]], [2, names[0]]] : [[0, names[0]], [1, names[1]], [2, names[2]]]).forEach(([i, name]) => {
    if (!name) return;
    const tip = [0, 0, 0]; tip[i] = arrow;
    const colour = AXES[lathe ? (i === 0 ? 2 : 0) : i];
    through(add(polyline([[0, 0, 0], tip], { width: 2.5, order: 7 }), colour));
    tip[i] = 1.25 * arrow;
    label(name, colour, tip, 22);
  });
  if (lathe) {
    const dash = [];
    for (let a = from[0]; a < to[0]; a += 0.05 * longest) dash.push([a, 0, 0], [a + 0.035 * longest, 0, 0], null);
    add(polyline(dash, { width: 1.5, order: 3 }), css("--soft"));
  }
  // Labels are as large on the stage whatever its scale; of crowded numbers every other one is left out, and so on, and
  // those that its edges would cut or that its `cover`, at the upper left, hides.
  const fit = (stage, cover) => {
    const { pixel_mm } = stage, at = new Vector3();
    const isClear = (sprite) => {
      const [w, h] = sprite.size_px.map((px) => px / 2 + 2), { x, y } = stage.project(sprite.getWorldPosition(at), at);
      const isCovered = cover && x - w < cover.offsetLeft + cover.offsetWidth && y - h < cover.offsetTop + cover.offsetHeight;
      return x > w && y > h && x < stage.width - w && y < stage.height - h && !isCovered;
    };
    let skip = 1;
    while (skip * step < 34 * pixel_mm) skip *= 2;
    for (const each of labels) each.scale.set(each.size_px[0] * pixel_mm, each.size_px[1] * pixel_mm, 1);
    for (const each of numbers) each.visible = Math.abs(Math.round(each.value / step)) % skip === 0 && isClear(each);
  };
  const whole = box.map((each) => [...each]);
  [[p, 0], [q, 1]].forEach(([i, n]) => { whole[i] = [from[n] - 1.6 * big, to[n] + 0.4 * big]; });
  return { group, lines: all, fit, box: whole };
}
