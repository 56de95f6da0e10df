// The path of the tool seen from above, and where it is.
const MOST = 4000;
export class Path {
  constructor(canvas) { this.canvas = canvas; this.points = []; }
  clear() { this.points = []; this.draw(); }
  add(x, y) {
    const last = this.points[this.points.length - 1];
    if (!last || Math.hypot(last[0] - x, last[1] - y) > 1e-3) {
      this.points.push([x, y]);
      if (this.points.length > MOST) this.points.splice(0, MOST / 4);
      this.draw();
    }
  }
  draw() {
    const { canvas, points } = this, pen = canvas.getContext("2d"), style = getComputedStyle(canvas);
    pen.clearRect(0, 0, canvas.width, canvas.height);
    if (!points.length) return;
    let [x0, y0, x1, y1] = [Infinity, Infinity, -Infinity, -Infinity];
    for (const [x, y] of points) { x0 = Math.min(x0, x); x1 = Math.max(x1, x); y0 = Math.min(y0, y); y1 = Math.max(y1, y); }
    const size = Math.max(x1 - x0, (y1 - y0) * canvas.width / canvas.height, 10) * 1.15, scale = canvas.width / size;
    const at = ([x, y]) => [canvas.width / 2 + (x - (x0 + x1) / 2) * scale, canvas.height / 2 - (y - (y0 + y1) / 2) * scale];
    pen.strokeStyle = style.color; pen.lineWidth = 2; pen.beginPath();
    points.forEach((point, index) => pen[index ? "lineTo" : "moveTo"](...at(point)));
    pen.stroke();
    const [x, y] = at(points[points.length - 1]);
    pen.fillStyle = style.accentColor; pen.beginPath(); pen.arc(x, y, 6, 0, 7); pen.fill();
  }
}
