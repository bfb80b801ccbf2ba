// What the colours mean.

const number = (value) => Number(value.toPrecision(4)).toString();

/** `shares` are shares of the filament by name; toggle(name) hides one or shows it again: `hidden` are names. */
export function showLegend(place, legends, { shares, hidden, toggle }) {
  place.hidden = legends.length === 0;
  place.replaceChildren();
  for (const legend of legends) {
    const title = document.createElement("h2");
    title.textContent = legend.unit ? `${legend.title}, ${legend.unit}` : legend.title;
    place.append(title);
    if (legend.ramp.length) {
      const ramp = document.createElement("div");
      ramp.className = "ramp";
      ramp.style.background = `linear-gradient(to right, ${legend.ramp.join(", ")})`;
      const ends = document.createElement("div");
      ends.className = "ends";
      ends.append(...[legend.least, legend.most].map((value) => {
        const end = document.createElement("span");
        end.textContent = number(value);
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
