// What the colours mean, in units as people write them.
import { clock, secondsOf } from "./answer.js";
import { withOrWithout } from "./state.js";
import { byId, checkbox, element, follow, renew, setOptions, swatch } from "./elements.js";

const UNITS = { "mm^3/s": "mm³/s", "mm/s^2": "mm/s²", C: "°C" };
const BARS = 32;
const isTime = (unit) => unit === "h:min:s";
const number = (value, unit) => (isTime(unit) ? clock(value) : Number(value.toPrecision(4)).toString());

export class Legend {
  #place = byId("legend");
  #legends = [];
  #shares = new Map(); // of the filament, by feature in their order
  #by_time = false; // the histogram

  /** page: see main.js. */
  constructor(page) {
    this.page = page;
    page.connection.on("facts", ({ facts }) => this.#setFeatures(facts.print?.features ?? []));
    page.connection.on("scene", ({ legends }) => this.#setLegends(legends));
  }

  #setFeatures(features) {
    const all = features.reduce((sum, each) => sum + each.volume_mm3, 0);
    this.#shares = new Map(features.map((each) => [each.name, each.volume_mm3 / all]));
  }
  /** A feature that is hidden stays in the legend, to be shown again. */
  #setLegends(legends) {
    const old = this.#legends.flatMap((each) => each.entries);
    const gone = ({ title, entries }) => old.filter(({ name }) => title === "feature" && this.page.state.hidden_features.includes(name) && !entries.some((each) => each.name === name));
    const place = ({ name }) => [...this.#shares.keys()].indexOf(name);
    const unitOf = ({ title, unit }) => (unit === "s" && title !== "pressure_advance" ? "h:min:s" : unit);
    this.#legends = legends.map((each) => ({ ...each, unit: unitOf(each), entries: [...each.entries, ...gone(each)].sort((a, b) => place(a) - place(b)) }));
    this.#place.hidden = legends.length === 0;
    const title = ({ title, unit }) => element("h2", {}, [title.replace("_", " "), UNITS[unit] ?? unit].filter(Boolean).join(", "));
    byId("legend-title").replaceChildren(...this.#legends.slice(0, 1).map(title));
    renew(byId("legend-of"), ...this.#legends.flatMap((each, n) => [...(n ? [title(each)] : []), ...(each.ramp.length ? this.#scale(each) : [this.#list(each)])]));
    this.weigh();
  }

  #scale({ least, most, unit, ramp }) {
    const bar = element("div", { className: "ramp" });
    bar.style.backgroundImage = `linear-gradient(to right, ${ramp.join(", ")})`;
    const inputs = [least, most].map((value, n) => {
      const input = element("input", { value: number(value, unit), ariaLabel: n ? "Most" : "Least" });
      input.addEventListener("change", () => {
        const text = input.value.trim();
        const typed = isTime(unit) ? secondsOf(text) : Number(text.replace(",", ".") || NaN);
        const range = n ? [least, typed] : [typed, most]; // what was not typed keeps its digits
        const wrong = !(Math.abs(typed) <= 1e9) ? `“${text}” is no ${isTime(unit) ? "time: write it as 0:10:00" : "number up to 1e9"}.` : range[0] < range[1] ? "" : "The lower end comes first.";
        told.textContent = wrong;
        if (wrong) input.value = number(value, unit);
        else this.page.change({ color_range: range });
      });
      return input;
    });
    const told = element("output", { className: "info" });
    const all = element("button", { type: "button", title: "From the least value to the most", hidden: !this.page.state.color_range }, "All");
    all.addEventListener("click", () => this.page.change({ color_range: null }));
    const ends = element("div", { className: "ends" }, inputs[0], all, inputs[1]);
    const by = element("select", { className: "by", ariaLabel: "Histogram" });
    setOptions(by, [["by length", ""], ["by time", "1"]]);
    by.value = this.#by_time ? "1" : "";
    follow(by, (value) => {
      this.#by_time = value !== "";
      this.weigh();
    });
    return [element("div", { className: "bars" }), bar, ends, told, by];
  }

  /** The histogram of what is shown now. */
  weigh() {
    const bars = this.#place.querySelector(".bars");
    if (!bars) return;
    const { least, most } = this.#legends.find((each) => each.ramp.length);
    const sums = this.page.own.histogram(this.page.state, least, most, BARS, this.#by_time);
    bars.hidden = this.#place.querySelector(".by").hidden = !sums;
    if (!sums) return bars.replaceChildren();
    const highest = Math.max(...sums);
    const unit = (sum) => (this.#by_time ? clock(sum) : `${(sum / 1000).toFixed(2)} m`);
    bars.replaceChildren(...sums.map((sum, n) => {
      const bar = element("i", { title: `from ${Number((least + ((most - least) * n) / BARS).toPrecision(4))}: ${unit(sum)}` });
      bar.style.height = `${highest ? (100 * sum) / highest : 0}%`;
      return bar;
    }));
  }

  #list({ title, entries }) {
    return element("ul", {}, ...entries.map(({ name, color }) => {
      const called = { feature: name.replaceAll("-", " "), tool: name.replace("tool ", "T"), object: name.replace(/^object 0$/, "no object") }[title] ?? name; // in the panel
      if (title !== "feature" || !this.#shares.has(name)) return element("li", {}, swatch(color), called);
      const { hidden_features: hidden } = this.page.state;
      const changed = (on) => this.page.select({ hidden_features: withOrWithout(hidden, name, !on) });
      const label = checkbox(name, changed, swatch(color), called, element("output", {}, `${(100 * this.#shares.get(name)).toFixed(1)} %`));
      label.control.checked = !hidden.includes(name);
      return element("li", {}, label);
    }));
  }
}
