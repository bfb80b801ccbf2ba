// The page of vdbview: the picture, and what changes it.
import { Answer } from "./answer.js";
import { OrbitCamera, handleInput } from "./camera.js";
import { Connection } from "./connection.js";
import { Controls } from "./controls.js";
import { showLegend } from "./legend.js";
import { fromFragment, initial, toFragment, toMessage } from "./state.js";

const byId = (id) => document.getElementById(id);
const picture = byId("picture");
const context = picture.getContext("2d");

let { state, file } = fromFragment(location.hash);
let orbit = state.camera.eye ? orbitOf(state.camera) : null;
let camera = null; // of the last picture
let aspect = 16 / 9;
let box = null;
let number = 0; // of the last view that was asked for
let asked = null; // a view that waits for the next frame
const sentAt = new Map(); // times by number
let latest = 0; // the number that the last picture answers
let shownSize = [0, 0]; // of the last view that was asked for
/** For measurements and tests: one entry a picture, and the number of the last view. */
const log = (window.vdbviewLog = []);
window.vdbviewAsked = () => number;

function orbitOf({ eye, look_at, fov }) {
  const way = [0, 1, 2].map((n) => look_at[n] - eye[n]);
  const length = Math.hypot(...way) || 1;
  return OrbitCamera.from({ eye, forward: way.map((v) => v / length), up: [0, 0, 1], fov }, look_at);
}

const connection = new Connection(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}${location.pathname}socket`);
const controls = new Controls({ state: () => state, changed: (moving) => ask(moving), hold, eye: () => camera?.eye ?? null });
const answer = new Answer(byId("answer"), byId("marks"));

// ---------------------------------------------------------------- asking

function pixels() {
  const ratio = Math.min(2, devicePixelRatio || 1);
  const side = (length) => Math.max(16, Math.min(4096, Math.round(length * ratio)));
  return [side(picture.clientWidth), side(picture.clientHeight)];
}

/** Shows the state; of many calls before the next frame, the last one counts. */
function ask(moving) {
  if (asked === null) requestAnimationFrame(sendAsked);
  asked = { moving };
}

function sendAsked() {
  const { moving } = asked;
  asked = null;
  if (!connection.ready) return;
  if (orbit) state.camera = orbit.toJSON();
  sentAt.set(++number, performance.now());
  shownSize = pixels();
  connection.send({ type: "show", number, moving, state: toMessage(state, shownSize) });
  if (!moving) history.replaceState(null, "", location.pathname + location.search + toFragment(state, file));
}

function setView(view) {
  orbit = null;
  state.camera = { view, fov: state.camera.fov };
  ask(false);
}

function fit() {
  if (!box || !camera) return;
  orbit ??= OrbitCamera.from(camera, middle());
  orbit.fit(box, aspect);
  ask(false);
}

/** A named view is fitted to what is shown; from here on it stays where the last picture was seen from. */
function hold() {
  if (!orbit && camera && box && latest === number) orbit = OrbitCamera.from(camera, middle());
}

const middle = () => [0, 1, 2].map((n) => (box[n] + box[n + 3]) / 2);

// ---------------------------------------------------------------- pictures

let shownKind = 0; // decoding may end in another order than it began

connection.addEventListener("picture", async ({ detail }) => {
  const arrived = performance.now();
  if (detail.kind === "saved") {
    connection.send({ type: "shown" });
    return download(detail);
  }
  const order = ++shownKind;
  const bitmap = await createImageBitmap(detail.file);
  connection.send({ type: "shown" });
  if (order !== shownKind && detail.kind === "moving") return;
  if (picture.width !== bitmap.width || picture.height !== bitmap.height) {
    picture.width = bitmap.width;
    picture.height = bitmap.height;
  }
  context.drawImage(bitmap, 0, 0);
  bitmap.close();
  camera = detail.camera;
  aspect = detail.width / detail.height;
  latest = detail.number;
  answer.draw(camera, aspect);
  byId("command").textContent = `${detail.command} -o picture.png`;
  byId("loading").hidden = true;
  if (byId("trouble").dataset.of === "view") byId("trouble").hidden = true;
  const now = performance.now();
  log.push({ kind: detail.kind, number: detail.number, at: now, latency: now - (sentAt.get(detail.number) ?? now), decode: now - arrived, width: detail.width, height: detail.height, bytes: detail.file.size });
  if (log.length > 20000) log.splice(0, 10000);
  for (const key of sentAt.keys()) if (key < detail.number) sentAt.delete(key);
  if (detail.kind === "final") {
    picture.dataset.final = detail.number;
    window.vdbviewFinal = detail.file;
  }
  say(detail.kind === "final" ? `${detail.width} × ${detail.height}, finished` : detail.kind === "rough" ? "finishing …" : `${detail.width} × ${detail.height}`);
});

function download({ file: blob }) {
  window.vdbviewSaved = blob;
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = `${byId("file").selectedOptions[0]?.textContent.replace(/\.[^.]*$/, "") || "picture"}.png`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  say("saved");
}

// ---------------------------------------------------------------- what the server says

const say = (text) => (byId("status").textContent = text);

function trouble(text, of = "") {
  byId("trouble-text").textContent = text;
  byId("trouble").dataset.of = of;
  byId("trouble").hidden = false;
  byId("loading").hidden = true;
}

connection.addEventListener("open", () => {
  if (byId("trouble").dataset.of === "connection") byId("trouble").hidden = true;
  document.body.dataset.connection = "open";
});
connection.addEventListener("gone", () => {
  document.body.dataset.connection = "gone";
  trouble("The server does not answer. It may have ended: start vdbview again. Trying to reconnect …", "connection");
});
connection.addEventListener("hello", ({ detail }) => {
  const files = byId("file");
  files.replaceChildren(...detail.files.map((name, n) => new Option(name, String(n))));
  files.parentElement.hidden = false;
  file = Math.min(file, detail.files.length - 1);
  files.value = String(file);
  document.title = `${detail.files[file]} · vdbview`;
  if (file > 0) connection.send({ type: "open", file });
  ask(false);
});
connection.addEventListener("loading", ({ detail }) => {
  byId("loading").hidden = false;
  byId("step").textContent = `${detail.step[0].toUpperCase()}${detail.step.slice(1)} …`;
  if (detail.done === undefined) byId("done").removeAttribute("value");
  else byId("done").value = detail.done;
});
connection.addEventListener("facts", ({ detail: { facts } }) => {
  controls.setFacts(facts);
  const print = facts.print;
  byId("facts").textContent = print
    ? [print.slicer, `${print.layers} layers`, `${print.height_mm.toFixed(1)} mm high`, `${(print.filament_mm / 1000).toFixed(2)} m of filament`].filter(Boolean).join(" · ")
    : "";
  byId("loading").hidden = latest > 0;
});
connection.addEventListener("scene", ({ detail }) => {
  box = detail.box;
  controls.setBox(box);
  showLegend(byId("legend"), detail.legends);
});
connection.addEventListener("progress", ({ detail }) => {
  if (detail.number === number) say(`finishing … ${Math.round(detail.done * 100)} %`);
});
connection.addEventListener("saving", ({ detail }) => say(`saving … ${Math.round(detail.done * 100)} %`));
connection.addEventListener("failed", ({ detail }) => trouble(detail.text, "view"));
connection.addEventListener("refused", ({ detail }) => trouble(detail.text, "view"));
connection.addEventListener("inspected", ({ detail }) => {
  window.vdbviewFound = detail;
  answer.show(detail);
  answer.draw(camera, aspect);
});

// ---------------------------------------------------------------- controls

function setMeasuring(on) {
  answer.measuring = on;
  answer.clear();
  byId("measure").setAttribute("aria-pressed", String(on));
  picture.classList.toggle("measuring", on);
  if (on) say("click two points");
}

async function copy(text, what) {
  try {
    await navigator.clipboard.writeText(text);
    say(`${what} copied`);
  } catch {
    trouble(text); // to be copied by hand
  }
}

handleInput(picture, {
  orbit: () => (orbit ??= camera && box ? OrbitCamera.from(camera, middle()) : new OrbitCamera()),
  moved: ask,
  clicked: (x, y) => connection.send({ type: "inspect", number, x: Math.min(1, Math.max(0, x)), y: Math.min(1, Math.max(0, y)) }),
  key: (event) => {
    const views = ["iso", "front", "back", "left", "right", "top", "bottom"];
    if (event.key in views) setView(views[event.key]);
    else if (event.key === "f" || event.key === "F") fit();
    else if (event.key === "m" || event.key === "M") setMeasuring(!answer.measuring);
    else if (event.key === "Escape") answer.clear();
    else if (event.key === "[" || event.key === "]") {
      const [low, high] = [state.layers[0] || 1, state.layers[1] || controls.layerCount];
      controls.setLayers(low, high + (event.key === "[" ? -1 : 1), false);
    }
  },
});

for (const button of document.querySelectorAll("[data-view]")) button.addEventListener("click", () => setView(button.dataset.view));
byId("fit").addEventListener("click", fit);
byId("measure").addEventListener("click", () => setMeasuring(!answer.measuring));
byId("trouble-close").addEventListener("click", () => (byId("trouble").hidden = true));
byId("copy-command").addEventListener("click", () => copy(byId("command").textContent, "command"));
byId("copy-link").addEventListener("click", () => copy(location.href, "link"));
byId("save").addEventListener("click", () => {
  const chosen = byId("save-size").value;
  if (orbit) state.camera = orbit.toJSON();
  say("saving …");
  connection.send({ type: "save", number: ++number, state: toMessage(state, chosen ? chosen.split("x").map(Number) : pixels()) });
});
byId("file").addEventListener("change", () => {
  file = Number(byId("file").value);
  state = initial();
  orbit = null;
  latest = 0;
  answer.clear();
  document.title = `${byId("file").selectedOptions[0].textContent} · vdbview`;
  connection.send({ type: "open", file });
  ask(false);
});
function showPanels(shown) {
  byId("side").classList.toggle("closed", !shown);
  byId("panels").setAttribute("aria-expanded", String(shown));
}
byId("panels").addEventListener("click", () => showPanels(byId("side").classList.contains("closed")));
if (matchMedia("(max-width: 760px)").matches) showPanels(false); // the picture first
window.addEventListener("hashchange", () => {
  ({ state } = fromFragment(location.hash));
  orbit = state.camera.eye ? orbitOf(state.camera) : null;
  controls.show();
  ask(false);
});


let resizeTimer = 0;
new ResizeObserver(() => {
  answer.draw(camera, aspect);
  clearTimeout(resizeTimer);
  resizeTimer = setTimeout(() => {
    if (String(pixels()) !== String(shownSize)) ask(false);
  }, 120);
}).observe(picture);
