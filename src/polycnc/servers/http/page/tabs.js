// The tabs: the run, and pages of what the machine has; one is shown at a time.
import { $, make } from "/dom.js";
import { TEXTS } from "/texts.js";
import "/programs_page.js";
import "/tables_page.js";
import "/values_page.js";
import "/log_page.js";
import "/vendor_page.js";
import "/scenario_page.js";

const PAGES = ["programs", "tools", "offsets", "parameters", "variables", "signals", "screen", "tasks", "alarms", "scenario", "snapshots", "connections"];

export class Tabs {
  constructor(link, place, run) {
    this.parts = {};
    this.panels = {};
    if (link.has("control")) this.panels.run = run;
    for (const name of PAGES) {
      const { needs } = customElements.get(`cnc-page-${name}`);
      if (needs && !link.has(needs)) continue;
      this.panels[name] = document.createElement(`cnc-page-${name}`).start(link, this.parts);
    }
    for (const [name, panel] of Object.entries(this.panels)) Object.entries({ id: `page-${name}`, role: "tabpanel", "aria-labelledby": `tab-${name}` }).forEach((pair) => panel.setAttribute(...pair));
    this.tabs = Object.keys(this.panels).map((name) => make("button", { id: `tab-${name}`, role: "tab", "aria-controls": `page-${name}`, onclick: () => this.open(name) }, TEXTS.pages[name]));
    const list = make("div", { role: "tablist", class: "tabs", "aria-label": TEXTS.all_pages }, ...this.tabs);
    list.addEventListener("keydown", (event) => {
      const at = this.tabs.indexOf(document.activeElement), count = this.tabs.length;
      const to = { ArrowRight: (at + 1) % count, ArrowLeft: (at - 1 + count) % count, Home: 0, End: count - 1 }[event.key];
      if (to === undefined || at < 0 || event.altKey) return;
      event.preventDefault();
      event.stopPropagation();
      this.tabs[to].focus();
    });
    run.hidden = true;
    place.replaceChildren(list, run, ...Object.values(this.panels).filter((panel) => panel !== run));
    this.open(Object.keys(this.panels)[0]);
  }

  open(name) {
    this.panels[this.shown]?.close?.();
    this.shown = name;
    for (const [each, panel] of Object.entries(this.panels)) panel.hidden = each !== name;
    for (const tab of this.tabs) tab.setAttribute("aria-selected", tab.id === `tab-${name}`);
    this.panels[name].open?.();
  }

  // Ask nothing any more: another machine is looked at.
  close() { this.panels[this.shown]?.close?.(); }

  inventory(parts) {
    Object.assign(this.parts, parts);
    this.panels[this.shown].changed?.(parts);
  }
}
