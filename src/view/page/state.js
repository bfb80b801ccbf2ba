// What is shown, as the server takes it, and its form in the URL's fragment.

/** The view of an input as it was given. */
export const initial = () => ({
  camera: { view: "", fov: 28 }, // as the input says
  layers: [0, 0],
  one_layer: false, // the first is moved with the last; for the page alone
  printed: 100,
  beads: null,
  by_time: false,
  hidden_features: [],
  objects: [],
  tools: [],
  color_by: "",
  color_range: null,
  material: "",
  light: "",
  light_rotation: 0,
  exposure: null,
  bed: null,
  bed_surface: "",
  smooth: false,
  clip: null,
  integrator: "",
  spp: 0,
  also: [], // what the browser draws besides beads; for the page alone
});

/** A list of names with one of them at its end, or without it. */
export const withOrWithout = (list, name, on) => list.filter((each) => each !== name).concat(on ? [name] : []);

/** For the server: without what is left open. */
export function toMessage(state, size) {
  const message = { ...state, size };
  for (const key of ["also", "one_layer"]) delete message[key];
  for (const key of ["exposure", "bed", "clip", "beads", "color_range"]) if (message[key] === null) delete message[key];
  return message;
}

/** What differs from the initial state, as text for the fragment. */
export function toFragment(state, file) {
  const first = initial();
  const changed = {};
  for (const key of Object.keys(first))
    if (JSON.stringify(first[key]) !== JSON.stringify(state[key])) changed[key] = state[key];
  if (file > 0) changed.file = file;
  return Object.keys(changed).length ? "#" + encodeURIComponent(JSON.stringify(changed)) : "";
}

const listOf = (each, count) => (value) => Array.isArray(value) && value.length === (count ?? value.length) && value.every(each);
const orOpen = (fits) => (value) => value === null || fits(value); // null: it is left open
const isText = (value) => typeof value === "string";
/** Which values fit a key; of others, those of the kind of the initial one. */
const FITS = {
  camera: isCamera,
  clip: orOpen(listOf(Number.isFinite, 4)),
  color_range: orOpen(listOf(Number.isFinite, 2)),
  layers: listOf(Number.isInteger, 2),
  hidden_features: listOf(isText),
  also: listOf(isText),
  beads: orOpen((value) => Number.isInteger(value) && value > 0),
  bed: orOpen((value) => typeof value === "boolean"),
  exposure: orOpen(Number.isFinite),
};
const fits = (key, value, first) => FITS[key]?.(value) ?? (typeof value === typeof first && Array.isArray(value) === Array.isArray(first));
function isCamera(value) {
  const point = (p) => Array.isArray(p) && p.length === 3 && p.every(Number.isFinite);
  if (value === null || typeof value !== "object" || !Number.isFinite(value.fov)) return false;
  return value.eye === undefined ? typeof value.view === "string" : point(value.eye) && point(value.look_at);
}

/** The state of a fragment, and in words what of it is of no use and left out; the server checks the values. */
export function fromFragment(fragment) {
  const state = initial();
  let file = 0;
  let changed = {};
  const wrong = [];
  try {
    changed = JSON.parse(decodeURIComponent(fragment.slice(1)) || "{}");
  } catch {
    wrong.push("it is cut short, or not of this page");
  }
  if (changed === null || typeof changed !== "object") changed = {};
  for (const [key, value] of Object.entries(changed))
    if (key === "file" && Number.isInteger(value) && value >= 0) file = value;
    else if (Object.hasOwn(state, key) && fits(key, value, state[key])) state[key] = value;
    else wrong.push(key.slice(0, 40));
  return { state, file, wrong: wrong.length ? `What the address says of the view is left out: ${wrong.slice(0, 5).join(", ")}.` : "" };
}
