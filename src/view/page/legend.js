// What the colours mean, in units as people write them.
import { clock } from "./answer.js";

const UNITS = { "mm^3/s": "mm³/s", C: "°C", s: "h:min:s" };
const number = (value, unit) => (unit === "s" ? clock(value) : Number(value.toPrecision(4)).toString());

export class Legend {
  #legends = [];
  #shares = new Map(); // of the filament, by feature

  /** toggle(name) hides a feature or shows it again: hidden() are names. */
  constructor(place, { hidden, toggle }) {
    Object.assign(this, { place, hidden, toggle });
  }

  setFeatures(features) {
    const all = features.reduce((sum, each) => sum + each.volume_mm3, 0);
    this.#shares = new Map(features.map((each) => [each.name, each.volume_mm3 / all]));
  }
  /** A feature that is hidden stays in the legend, to be shown again. */
  setLegends(legends) {
    const old = this.#legends.flatMap((each) => each.entries);
    const gone = ({ title, entries }) => old.filter(({ name }) => title === "feature" && this.hidden().includes(name) && !entries.some((each) => each.name === name));
    this.#legends = legends.map((each) => ({ ...each, entries: [...each.entries, ...gone(each)] }));
    show(this.place, this.#legends, { shares: this.#shares, hidden: this.hidden(), toggle: this.toggle });
  }
}

function show(place, legends, { shares, hidden, toggle }) {
  place.hidden = legends.length === 0;
  place.replaceChildren();
  for (const legend of legends) {
    const title = document.createElement("h2");
    title.textContent = [legend.title.replace("_", " "), UNITS[legend.unit] ?? legend.unit].filter(Boolean).join(", ");
    place.append(title);
    if (legend.ramp.length) {
      const ramp = document.createElement("div");
      ramp.className = "ramp";
      ramp.style.background = `linear-gradient(to right, ${legend.ramp.join(", ")})`;
      const ends = document.createElement("div");
      ends.className = "ends";
      ends.append(...[legend.least, legend.most].map((value) => {
        const end = document.createElement("span");
        end.textContent = number(value, legend.unit);
        return end;
      }));
      place.append(ramp, ends);
      continue;
    }
    const list = document.createElement("ul");
    for (const entry of legend.entries) {
      const item = document.createElement("li");
      const swatch = document.createElement("span");
      swatch.className = "swatch";
      swatch.style.background = entry.color;
      item.append(swatch, entry.name);
      list.append(item);
      if (legend.title !== "feature" || !shares.has(entry.name)) continue;
      item.append(Object.assign(document.createElement("output"), { textContent: `${(100 * shares.get(entry.name)).toFixed(1)} %` }));
      item.setAttribute("role", "checkbox");
      item.setAttribute("aria-checked", String(!hidden.includes(entry.name)));
      item.tabIndex = 0;
      const press = () => toggle(entry.name);
      item.addEventListener("click", press);
      item.addEventListener("keydown", (event) => (event.key === " " || event.key === "Enter") && (event.preventDefault(), press()));
    }
    place.append(list);
  }
}
