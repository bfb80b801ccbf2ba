// What is shown, as the server takes it, and its form in the URL's fragment.

/** The view of an input as it was given. */
export const initial = () => ({
  camera: { view: "iso", fov: 28 },
  layers: [0, 0],
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
  also: [], // what the browser draws besides beads; the server knows nothing of it
});

/** For the server: without what is left open. */
export function toMessage(state, size) {
  const message = { ...state, size };
  delete message.also;
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

// Whether a value is of the kind of another; null stands for a number, a plane or a switch that is left open.
function fits(key, value, first) {
  if (key === "camera") return isCamera(value);
  if (key === "clip") return value === null || (Array.isArray(value) && value.length === 4 && value.every(Number.isFinite));
  if (key === "color_range") return value === null || (Array.isArray(value) && value.length === 2 && value.every(Number.isFinite));
  if (key === "layers") return Array.isArray(value) && value.length === 2 && value.every(Number.isInteger);
  if (["hidden_features", "also"].includes(key)) return Array.isArray(value) && value.every((each) => typeof each === "string");
  if (key === "beads") return value === null || (Number.isInteger(value) && value > 0);
  if (first === null) return value === null || typeof value === (key === "bed" ? "boolean" : "number");
  return typeof value === typeof first && Array.isArray(value) === Array.isArray(first);
}
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
    else if (key in state && fits(key, value, state[key])) state[key] = value;
    else wrong.push(key.slice(0, 40));
  return { state, file, wrong: wrong.length ? `What the address says of the view is left out: ${wrong.slice(0, 5).join(", ")}.` : "" };
}
