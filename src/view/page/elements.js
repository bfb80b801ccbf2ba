// Elements of the page: found, made, and listened to.

export const byId = (id) => document.getElementById(id);

/** Nothing is laid out and painted anew where the text is what it was: while the view turns, that is every frame. */
export function setText(place, text) {
  if (place.textContent !== text) place.textContent = text;
}

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

/** A box with its label, which is `beside`; changed(on) when it is ticked or not. */
export function checkbox(value, changed, ...beside) {
  const box = element("input", { type: "checkbox", value });
  follow(box, changed);
  return element("label", {}, box, ...beside);
}

/** take(value, moving) of a control; a slider tells also while it moves. */
export function follow(control, take) {
  const value = () => (control.type === "checkbox" ? control.checked : control.type === "range" ? control.valueAsNumber : control.value);
  if (control.type === "range") control.addEventListener("input", () => take(value(), true));
  control.addEventListener("change", () => take(value(), false));
}
export function setValue(control, value) {
  if (control.type === "checkbox") control.checked = value;
  else control.value = value;
}

/** Other children for a place. What has the focus there keeps it, if there is one of the same name or value again. */
export function renew(place, ...children) {
  const name = (each) => each.ariaLabel || each.value;
  const focused = place.contains(document.activeElement) ? name(document.activeElement) : undefined;
  place.replaceChildren(...children);
  if (focused !== undefined) [...place.querySelectorAll("input, select, button")].find((each) => name(each) === focused)?.focus();
}

/** Pairs of text and value as the options of a list. */
export function setOptions(list, pairs) {
  list.replaceChildren(...pairs.map(([text, value]) => new Option(text, value)));
}
