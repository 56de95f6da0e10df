// A listing of any length: only the lines in sight exist.
const ROW_PX = 20;

export class Listing {
  // `texts` and `lines` by row; line 0 is the name of a program. `remarks` by row: {kind, text}. `onRow(row)`: a click.
  constructor(holder, rows, { texts, lines, remarks, onRow }) {
    Object.assign(this, { holder, rows, texts, lines, remarks, lit: -1 });
    rows.style.height = `${texts.length * ROW_PX}px`;
    holder.onscroll = () => this.draw();
    rows.onclick = (event) => { const row = event.target.closest(".row"); if (row && lines[row.dataset.row]) onRow(Number(row.dataset.row)); };
    new ResizeObserver(() => this.draw()).observe(holder);
  }

  draw() {
    const first = Math.max(Math.floor(this.holder.scrollTop / ROW_PX) - 5, 0);
    const last = Math.min(first + Math.ceil(this.holder.clientHeight / ROW_PX) + 10, this.texts.length);
    const shown = [];
    for (let i = first; i < last; i++) {
      const row = document.createElement("div"), remark = this.remarks.get(i);
      row.className = ["row", this.lines[i] ? "" : "name", i === this.lit ? "lit" : "", remark ? remark.kind : ""].join(" ");
      row.style.top = `${i * ROW_PX}px`;
      row.dataset.row = i;
      row.setAttribute("role", "option");
      row.setAttribute("aria-selected", i === this.lit);
      if (remark) row.title = remark.text;
      if (this.lines[i]) row.append(Object.assign(document.createElement("b"), { textContent: this.lines[i] }));
      row.append(this.texts[i]);
      shown.push(row);
    }
    this.rows.replaceChildren(...shown);
  }

  light(row) {
    this.lit = row;
    const top = row * ROW_PX;
    if (row >= 0 && (top < this.holder.scrollTop || top + ROW_PX > this.holder.scrollTop + this.holder.clientHeight)) {
      this.holder.scrollTop = top - this.holder.clientHeight / 2;
    }
    this.draw();
  }
}
