// Elements of the page: found, made, and listened to.

export const byId = (id) => document.getElementById(id);

/** Pixels of a picture by those of CSS; more than two are not seen. */
export const pixelRatio = () => Math.min(2, devicePixelRatio || 1);

export function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

export function swatch(color) {
  const made = element("span", { className: "swatch" });
  made.style.background = color;
  return made;
}

/** A box with its label, which is `beside`; changed(box) when it is ticked or not. */
export function checkbox(value, changed, ...beside) {
  const box = element("input", { type: "checkbox", value });
  box.addEventListener("change", () => changed(box));
  return element("label", {}, box, ...beside);
}

/** take(value, moving) of a slider, while it moves and where it stops. */
export function follow(slider, take) {
  slider.addEventListener("input", () => take(Number(slider.value), true));
  slider.addEventListener("change", () => take(Number(slider.value), false));
}

/** Other children for a place. What has the focus there keeps it, if there is one of the same name or value again. */
export function renew(place, ...children) {
  const name = (each) => each.dataset.name ?? (each.ariaLabel || each.value);
  const focused = place.contains(document.activeElement) ? name(document.activeElement) : undefined;
  place.replaceChildren(...children);
  if (focused !== undefined) [...place.querySelectorAll("[tabindex], input, select, button")].find((each) => name(each) === focused)?.focus();
}

/** Pairs of text and value as the options of a list. */
export function setOptions(list, pairs) {
  list.replaceChildren(...pairs.map(([text, value]) => new Option(text, value)));
}
