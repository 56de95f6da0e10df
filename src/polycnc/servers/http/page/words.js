// Feed, speed and tool, the modal words, the overrides.
import { $, make, put } from "/dom.js";
import { Held } from "/held.js";
import { TEXTS } from "/texts.js";

const OVERRIDES = { feed: { max: 200, step: 5 }, rapid: { max: 100, step: 25 }, spindle: { max: 200, step: 5 } };

export class Words {
  constructor(link) {
    this.held = Object.fromEntries(Object.keys(OVERRIDES).map((name) => [name, new Held()]));
    const figures = (head, from) => [make("b", {}, head), ...[0, 1, 2].map((k) => make("b", { id: `figure${from + k}` }, "0"))];
    $("fst").replaceChildren(make("b", { id: "tool" }), ...["programmed", "commanded", "actual"].map((key) => make("i", {}, TEXTS[key])), ...figures("F", 0), ...figures("S", 3));
    $("overrides").replaceChildren(...Object.entries(OVERRIDES).map(([name, range]) => make("label", {}, TEXTS[name],
      make("input", { type: "range", id: `override-${name}`, min: 0, value: 100, ...range,
        onchange: ({ target: { value } }) => this.held[name].send(link.given("set_overrides", { [name]: Number(value) / 100 })),
        oninput: (event) => put($(`override-${name}-is`), `${event.target.value} %`) }),
      make("output", { id: `override-${name}-is` }))));
  }

  show(status, channel) {
    const { feed, modal, overrides } = channel, { spindle } = status;
    const figures = [feed.programmed, feed.commanded, feed.actual, spindle.programmed_rpm, spindle.commanded_rpm, spindle.actual_rpm];
    for (const [index, value] of figures.entries()) put($(`figure${index}`), Number(value ?? 0).toFixed(0));
    put($("tool"), `T${channel.tool.number}`);
    const words = modal ? [...Object.values(modal.g ?? {}), ...(modal.m ?? []).map((code) => `M${code}`)] : [];
    put($("modal"), words.filter((word) => typeof word === "string").join(" "));
    for (const name of Object.keys(OVERRIDES)) {
      const slider = $(`override-${name}`), value = Math.round(overrides[name] * 100);
      if (this.held[name].holds || slider.matches(":active")) continue; // it has just been turned, or is being drawn
      slider.value = value;
      put($(`override-${name}-is`), `${value} %`);
    }
  }
}
