// What the colours mean.

const number = (value) => Number(value.toPrecision(4)).toString();

export function showLegend(place, legends) {
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
    }
    place.append(list);
  }
}
