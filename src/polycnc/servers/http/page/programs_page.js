// Programs of the memory: edited with their errors, brought and taken as files, compared.
import { button, make, say } from "/dom.js";
import { difference } from "/difference.js";
import { Page } from "/page_base.js";
import { TEXTS } from "/texts.js";
import "/editor.js";

const CHECK_MS = 500, ASK_MS = 4000, MOST_CHECKED = 200_000, NEAR = 3, MOST_FILES = 100;
const at = (name) => `programs/${encodeURIComponent(name)}`;
const nameOf = (file) => file.name.replace(/\.[^.]*$/, "");

class Programs extends Page {
  static follows = ["programs"];
  static needs = "control";

  open() { if (!this.editor) this.build(); else this.list(); }
  changed(parts) { if (parts.programs && this.editor) this.list(); }

  build() {
    Object.assign(this, { choices: 0, coming: 0, comparing: 0 });
    this.names = make("select", { id: "names", "aria-label": TEXTS.programs, onchange: () => { this.wanted = null; this.choices++; this.point(); } });
    this.file = make("input", { type: "file", id: "file", multiple: "", hidden: "", onchange: () => { this.bring([...this.file.files]); this.file.value = ""; } });
    this.download = make("a", { id: "download", class: "button", draggable: "true" }, TEXTS.download);
    this.download.addEventListener("dragstart", (event) => event.dataTransfer.setData("DownloadURL", `text/plain:${this.download.download}:${this.download.href}`));
    this.name = make("input", { id: "new", placeholder: TEXTS.name, "aria-label": TEXTS.name, maxlength: "64" });
    this.editor = make("cnc-editor", { for: "text", label: TEXTS.edit_text });
    this.found = make("ol", { id: "errors", role: "status" });
    this.differences = make("div", { id: "differences", class: "wide", tabindex: "0", hidden: "" });
    this.replaceChildren(
      make("p", { class: "row" }, this.names, button("select", TEXTS.select, () => this.link.command("select_program", { program: this.names.value })),
        button("edit", TEXTS.edit, () => this.edit()), this.download, button("remove", TEXTS.remove, ({ currentTarget }) => this.remove(currentTarget))),
      make("p", { class: "row" }, this.name, button("save", TEXTS.save, () => this.save()), button("compare", TEXTS.compare, () => this.compare()),
        button("bring", TEXTS.bring, () => this.file.click()), this.file, make("span", { class: "hint inline" }, TEXTS.drop)),
      this.editor, this.found, this.differences);
    this.editor.addEventListener("input", () => this.checkSoon());
    this.editor.addEventListener("keydown", (event) => { if (event.key === "s" && (event.ctrlKey || event.metaKey)) { event.preventDefault(); this.save(); } });
    this.addEventListener("dragover", (event) => { event.preventDefault(); this.classList.add("over"); });
    this.addEventListener("dragleave", () => this.classList.remove("over"));
    this.addEventListener("drop", (event) => { event.preventDefault(); this.classList.remove("over"); this.bring([...event.dataTransfer.files]); });
    this.list();
  }

  list() {
    const chosen = this.wanted ?? this.names.value; // one that was saved is chosen as soon as it is in the list
    this.names.replaceChildren(...(this.parts.programs ?? []).map((entry) => make("option", { value: entry.name }, `${entry.name} ${entry.comment}`)));
    if ((this.parts.programs ?? []).some((entry) => entry.name === chosen)) { this.names.value = chosen; this.wanted = null; }
    this.point();
  }
  point() {
    const name = this.names.value;
    this.download.classList.toggle("off", !name);
    if (!name) { this.download.removeAttribute("href"); return; }
    this.download.href = this.link.url(at(name));
    this.download.download = name.includes(".") ? name : `${name}.nc`;
  }

  edit() { if (this.names.value) this.bringText(this.names.value, this.link.text(at(this.names.value))); }
  // Put a text that is on its way into the editor, unless another was asked for, or somebody has written there meanwhile.
  async bringText(name, coming) {
    const turn = ++this.coming, before = this.editor.value, named = this.name.value, text = await coming;
    if (turn !== this.coming || (text ?? null) === null) return;
    if (this.editor.value === before && this.name.value === named) this.put(name, text); else say(TEXTS.left_as_written(name));
  }
  put(name, text) {
    this.name.value = name;
    this.editor.value = text;
    this.differences.hidden = true;
    this.check();
  }
  async save() {
    const name = this.name.value.trim();
    if (!name) { say(TEXTS.name_it); this.name.focus(); return; }
    const { choices } = this;
    if (!(await this.send("PUT", at(name), this.editor.value))) return;
    say(TEXTS.saved(name));
    if (choices !== this.choices) return; // another one was chosen meanwhile
    this.wanted = name;
    this.list();
  }
  // The first press asks, the second one deletes; a question of the browser would hold up the whole page.
  remove(key) {
    const name = this.names.value, sure = key.dataset.name === name;
    const ask = (text, of) => { key.textContent = text; key.dataset.name = of; };
    clearTimeout(this.asking);
    ask(TEXTS.remove, "");
    if (!name) return;
    if (sure) { this.send("DELETE", at(name)); return; }
    ask(TEXTS.sure(name), name);
    this.asking = setTimeout(() => ask(TEXTS.remove, ""), ASK_MS);
  }

  // One file is put into the editor; several go into the memory, where none is replaced.
  async bring(files) {
    if (files.length === 1) { await this.bringText(nameOf(files[0]), files[0].text()); return; }
    const there = new Set((this.parts.programs ?? []).map((entry) => entry.name)), left = [];
    let count = 0;
    for (const file of files.slice(0, MOST_FILES)) {
      if (there.has(nameOf(file)) || !(await this.send("PUT", at(nameOf(file)), await file.text()))) left.push(file.name); else count++;
    }
    say([TEXTS.brought(count), left.length ? TEXTS.left_out(left.join(", ")) : ""].join(" "));
  }

  checkSoon() {
    clearTimeout(this.soon);
    this.soon = setTimeout(() => this.check(), CHECK_MS);
  }
  // One check at a time: what is written meanwhile is checked after it.
  async check() {
    clearTimeout(this.soon);
    if (this.checking) { this.again_check = true; return; }
    const text = this.editor.value;
    if (!text.trim() || text.length > MOST_CHECKED) { this.tell([], text.trim() ? TEXTS.too_long : ""); return; }
    this.checking = true;
    const errors = await this.link.json(`check?program=${encodeURIComponent(this.name.value.trim() || "program")}`, { method: "POST", body: text });
    this.checking = false;
    if (errors && text === this.editor.value) this.tell(errors, errors.length ? "" : TEXTS.no_errors);
    if (this.again_check) { this.again_check = false; this.check(); }
  }
  tell(errors, otherwise) {
    this.editor.show(errors.filter((each) => each.line));
    this.found.replaceChildren(...errors.map((each) => make("li", {}, make("button", { class: "small", onclick: () => this.editor.go(each.line || 1, each.column) },
      each.line ? `${TEXTS.line} ${each.line}` : TEXTS.elsewhere), ` ${each.text} `, make("span", { class: "hint inline" }, each.hint))),
    ...(otherwise ? [make("li", { class: "well" }, otherwise)] : []));
  }

  // What the editor has differs from the chosen program of the memory like this.
  async compare() {
    const name = this.names.value, turn = ++this.comparing, text = name && (await this.link.text(at(name)));
    if (!name || (text ?? null) === null || turn !== this.comparing) return;
    const all = difference(text, this.editor.value), changes = all?.filter((each) => each.kind !== "same").length;
    const near = all?.map((each, k) => all.slice(Math.max(0, k - NEAR), k + NEAR + 1).some((other) => other.kind !== "same"));
    const rows = (all ?? []).flatMap((each, k) => (near[k] ? [make("p", { class: each.kind }, `${String(each.a || "").padStart(5)} ${String(each.b || "").padStart(5)} ${{ same: " ", gone: "−", new: "+" }[each.kind]} ${each.text}`)]
      : near[k - 1] ? [make("p", { class: "gap" }, "⋯")] : []));
    this.differences.hidden = false;
    this.differences.replaceChildren(make("h3", {}, all ? TEXTS.compared(name, changes) : TEXTS.too_different), ...rows);
    this.differences.scrollIntoView({ block: "nearest" });
  }
}
customElements.define("cnc-page-programs", Programs);
