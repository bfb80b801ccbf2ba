// The page of vdbview: the picture, and what changes it.
import { Answer, clock } from "./answer.js";
import { OrbitCamera, handleInput, middleOf } from "./camera.js";
import { Connection } from "./connection.js";
import { Controls } from "./controls.js";
import { byId, pixelRatio, setOptions, setText } from "./elements.js";
import { Finder } from "./finder.js";
import { MotionPanel } from "./motion_panel.js";
import { OwnPicture } from "./own_picture.js";
import { Legend } from "./legend.js";
import { Saving } from "./saving.js";
import { SecondPrint } from "./second_print.js";
import { Sending } from "./sending.js";
import { fromFragment, initial, toFragment, toMessage } from "./state.js";

const picture = byId("picture");
const context = picture.getContext("2d");

let { state, file, wrong } = fromFragment(location.hash);
const orbitOf = ({ camera: its }) => (its.eye ? OrbitCamera.fromJSON(its) : null); // null: a named view
let orbit = orbitOf(state);
let camera = null; // of the last picture
let aspect = 16 / 9;
let box = null;
let number = 0; // of the last view that was asked for
let asked = null; // a view that waits for the next frame
const sentAt = new Map(); // times by number
let viewFrom = 0; // the first number that the named view has
let latest = 0; // the number that the last picture answers
let awaited = false; // a finished picture
let shownSize = [0, 0]; // of the last view that was asked for
let shownView = ""; // the same
let onTop = {}; // the server's picture over the browser's own: its view, and whether it is finished
/** For measurements and tests: one entry a picture, the number of the last view, and of each kind of moves how many are shown. */
const log = (window.vdbviewLog = []);
window.vdbviewAsked = () => number;
window.vdbviewCounts = () => own.counts();

const url = `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}${location.pathname}socket`;
const connection = new Connection(url);
const own = new OwnPicture(byId("beads"));
const streamed = new URLSearchParams(location.search).has("stream"); // as if there were no WebGL2
/** What the parts of the page know of it. */
const page = {
  connection,
  own,
  ask,
  say,
  pixels,
  get state() {
    return state;
  },
  /** Of the last picture; null: there is none. */
  get camera() {
    return camera;
  },
  get aspect() {
    return aspect;
  },
  trouble,
  openFile,
  /** Other values of the state. */
  change(values, moving = false) {
    Object.assign(state, values);
    controls.show();
    ask(moving);
  },
  /** The same of what is printed, which must not move the camera. */
  select(values, moving) {
    hold();
    page.change(values, moving);
  },
};
const controls = (page.controls = new Controls(page));
const legend = new Legend(page);
const motion = (page.motion = new MotionPanel(page));
const second = new SecondPrint(page);
const finder = new Finder(page);
const saving = new Saving(page);
new Sending(page);
const answer = new Answer(page);

// ---------------------------------------------------------------- asking

function pixels() {
  const side = (length) => Math.max(16, Math.min(4096, Math.round(length * pixelRatio())));
  return [side(picture.clientWidth), side(picture.clientHeight)];
}

let sentLast = 0;
/** Shows the state; of many calls before the next frame, the last one counts. */
function ask(moving) {
  if (asked === null) requestAnimationFrame(sendAsked);
  asked = { moving };
}

function sendAsked() {
  const { moving } = asked;
  // Displays may be faster than the server lets a page ask.
  if (moving && performance.now() - sentLast < 7) return requestAnimationFrame(sendAsked);
  sentLast = performance.now();
  asked = null;
  if (orbit) state.camera = orbit.toJSON();
  shownSize = pixels();
  if (own.ready) drawOwn(moving);
  motion.show();
  if (!connection.ready) return;
  sentAt.set(++number, performance.now());
  shownView = viewOf();
  const stops = own.ready && moving; // the picture that the server is at
  if (!stops || awaited) connection.send({ type: "show", number, moving, own: own.table?.complete && !own.why, state: toMessage(state, shownSize) });
  awaited = !stops;
  if (!moving) history.replaceState(null, "", location.pathname + location.search + toFragment(state, file));
}

const viewOf = () => JSON.stringify([state, shownSize]);
function hideServers() {
  picture.classList.add("behind");
  onTop = {};
}

/** The beads in front of the camera, at once; a named view waits for the server, which fits it. The server's picture of the
 * same view stays on top until all beads are in this one. */
function drawOwn(moving) {
  camera = orbit?.camera ?? camera;
  if (!camera) return;
  aspect = shownSize[0] / shownSize[1];
  if (moving || viewOf() !== onTop.view) hideServers();
  byId("loading").hidden = true;
  // The server is not asked while the view moves.
  if (document.body.classList.contains("stale") && byId("trouble").dataset.of === "nothing" && !own.table.isEmpty(state)) good();
  answer.lines = null;
  answer.head = own.head(state);
  own.draw(camera, state, shownSize, moving);
  second.draw(camera, state, shownSize, moving);
  answer.draw();
  const [width, height] = own.size;
  record({ kind: "own", number, at: performance.now(), width, height, bytes: 0 });
  if (moving) say(`${width} × ${height}`);
}

own.addEventListener("complete", () => {
  if (!onTop.finished) hideServers();
  answer.lines = own.lines();
  answer.draw();
});
own.addEventListener("moves", () => ask(false));
own.addEventListener("changed", () => {
  if (own.why) onTop = {}; // it may be of another file, or of an older one
  motion.show();
  byId("mover").textContent = own.ready ? "drawn by this browser" : `streamed by the server${own.why ? `: ${own.why}` : ""}`;
  document.body.dataset.moving = own.ready ? "own" : "stream";
  if (own.table?.complete && !own.why && !own.ready) ask(false); // for the light
  if (own.why && latest > 0 && picture.classList.contains("behind")) ask(false);
});

function setView(view) {
  setState({ ...state, camera: { view, fov: state.camera.fov } });
  ask(false);
}

function fit() {
  if (!box || !camera) return;
  turned().fit(box, aspect);
  ask(false);
}

/** A named view is fitted to what is shown; from here on it stays where it was seen from. */
function hold() {
  if (camera && box && latest >= viewFrom) turned();
}

/** The camera that turns, from where the last picture was seen. */
const turned = () => Object.assign((orbit ??= camera && box ? OrbitCamera.from(camera, middleOf(box)) : new OrbitCamera()), { unit: 1 / answer.mm });

// ---------------------------------------------------------------- pictures

let [arrivedLast, drawnLast] = [0, 0]; // decoding may end in another order than it began

connection.on("picture", async (detail) => {
  const arrived = performance.now();
  if (detail.kind === "saved") return connection.send({ type: "shown" });
  const order = ++arrivedLast;
  const bitmap = await createImageBitmap(detail.file);
  connection.send({ type: "shown" });
  const late = order < drawnLast || (order < arrivedLast && detail.kind === "moving");
  if (late || (own.ready && detail.number !== number)) return bitmap.close(); // it has moved on
  drawnLast = order;
  if (picture.width !== bitmap.width || picture.height !== bitmap.height) {
    picture.width = bitmap.width;
    picture.height = bitmap.height;
  }
  context.drawImage(bitmap, 0, 0);
  bitmap.close();
  if (detail.number === number) picture.classList.remove("behind");
  onTop = detail.number === number ? { view: shownView, finished: detail.kind === "final" } : {};
  if (detail.number >= viewFrom) camera = detail.camera;
  aspect = detail.width / detail.height;
  latest = detail.number;
  good();
  answer.draw();
  tellCommand(detail);
  byId("loading").hidden = true;
  const now = performance.now();
  record({ kind: detail.kind, number: detail.number, at: now, latency: now - (sentAt.get(detail.number) ?? now), decode: now - arrived, width: detail.width, height: detail.height, bytes: detail.file.size });
  for (const key of sentAt.keys()) if (key < detail.number) sentAt.delete(key);
  if (detail.kind === "final") {
    if (detail.number === number) awaited = false;
    picture.dataset.final = detail.number;
    window.vdbviewFinal = detail.file;
    motion.show(true);
  }
  say(detail.kind === "final" ? `${detail.width} × ${detail.height}, finished` : detail.kind === "rough" ? "finishing …" : `${detail.width} × ${detail.height}`);
});

function record(entry) {
  log.push(entry);
  if (log.length > 20000) log.splice(0, 10000);
}

// ---------------------------------------------------------------- what the server says

const tellCommand = ({ command }) => (byId("command").textContent = `${command} -o picture.png`);
function say(text) {
  setText(byId("status"), text);
}
function trouble(text, of = "") {
  byId("trouble-text").textContent = text;
  byId("trouble").dataset.of = of;
  byId("trouble").hidden = false;
  byId("loading").hidden = true;
}
/** The view that was asked for can be shown. */
function good() {
  document.body.classList.remove("stale");
  if (["view", "nothing"].includes(byId("trouble").dataset.of)) byId("trouble").hidden = true;
}

const on = (type, take) => connection.on(type, take);
on("open", () => {
  if (byId("trouble").dataset.of === "connection") byId("trouble").hidden = true;
  document.body.dataset.connection = "open";
});
on("gone", ({ reason }) => {
  document.body.dataset.connection = "gone";
  const why = reason ? `The server has closed the connection: ${reason}.` : "The server does not answer. It may have ended: start vdbview again.";
  trouble(`${why} Trying to reconnect …`, "connection");
});
on("stranger", () => trouble("The server was started anew, and its page has another address: open the one that it prints.", "connection"));
on("hello", (detail) => {
  if (wrong) trouble(wrong);
  wrong = "";
  setFiles(detail);
  if (file > 0) connection.send({ type: "open", file });
  ask(false);
});
on("files", setFiles);
function setFiles({ files }) {
  setOptions(byId("file"), files.map((name, n) => [name, n]));
  nameFile(file);
}
/** One of the inputs, or the last one. */
function nameFile(wanted) {
  const names = [...byId("file").options].map((each) => each.textContent);
  file = Math.min(wanted, names.length - 1);
  byId("file").value = String(file);
  byId("file").title = names[file];
  document.title = `${names[file]} · vdbview`;
  second.setFiles(names, file);
}
function openFile(wanted, view = initial()) {
  controls.reset();
  nameFile(wanted);
  setState(view);
  latest = 0;
  camera = null;
  answer.reset();
  print = null;
  saving.stop();
  connection.send({ type: "open", file });
  own.open();
  ask(false);
}
function setState(view) {
  state = view;
  orbit = orbitOf(view);
  viewFrom = number + 1;
}
if (streamed) own.refuse("as the address asks");
else own.listen(connection);
on("no-moves", (detail) => {
  state.also = [];
  motion.show();
  trouble(detail.text, "view");
});
on("layers", tellFacts);
on("look", (detail) => {
  tellCommand(detail);
  if (detail.number !== number) return own.illuminate(detail);
  if (!orbit) camera = detail.camera;
  aspect = detail.width / detail.height;
  latest = detail.number;
  good();
  motion.show(true);
  own.illuminate(detail);
  legend.weigh();
  if (own.ready) drawOwn(false);
});
on("loading", (detail) => {
  if (own.ready) return say(`${detail.step} …`); // nothing lies on a picture that is there
  byId("loading").hidden = false;
  byId("step").textContent = `${detail.step[0].toUpperCase()}${detail.step.slice(1)} …`;
  if (detail.done === undefined) byId("done").removeAttribute("value");
  else byId("done").value = detail.done;
});
let print = null; // what is known of it
let generation; // of its file
function tellFacts() {
  const seconds = print?.seconds ? clock(print.seconds) : motion.planned && `${clock(motion.planned)} planned`;
  byId("facts").title = byId("facts").textContent = print
    ? [seconds, print.grams && `${print.grams.toFixed(1)} g`, print.cost && `costs ${print.cost.toFixed(2)}`, `${(print.filament_mm / 1000).toFixed(2)} m of filament`, `${print.layers} layers`, `${print.height_mm.toFixed(2).replace(/0$/, "")} mm high`, print.slicer].filter(Boolean).join(" · ")
    : "";
}
on("facts", ({ facts }) => {
  if (!print || generation !== facts.generation) {
    motion.setFacts(facts);
    finder.reset();
  }
  print = facts.print;
  own.setBed(print?.bed ?? null, print?.excluded);
  motion.show();
  tellFacts();
  byId("loading").hidden = latest > 0;
  generation = facts.generation;
});
on("scene", (detail) => {
  box = detail.box;
  answer.mm = detail.mm_per_unit;
});
on("progress", (detail) => {
  if (detail.number === number) say(`finishing … ${Math.round(detail.done * 100)} %`);
});
on("failed", (detail) => {
  const nothing = controls.whyNothing(detail.text);
  trouble(nothing ? `Nothing is shown: ${nothing}.` : detail.text, nothing ? "nothing" : "view");
  say("");
  document.body.classList.add("stale"); // what is on the screen is not what was asked for
  byId("command").textContent = "";
});
on("refused", ({ text }) => {
  if (text.startsWith("the program has no line")) return finder.say(`The${text.slice(3)}.`);
  // A link of another version may ask for what this one does not know: the input itself is shown then.
  if (latest === 0 && toFragment(state, file) !== toFragment(initial(), file)) {
    setState(initial());
    ask(false);
  }
  trouble(text, "view");
});
on("inspected", (detail) => {
  window.vdbviewFound = detail;
  if (turns) turnAbout(detail);
  answer.show(detail);
  answer.draw();
});

// ---------------------------------------------------------------- controls

function setMeasuring(on) {
  answer.measuring = on;
  answer.clear();
  byId("measure").setAttribute("aria-pressed", String(on));
  picture.classList.toggle("measuring", on);
  if (on) say("click two points");
}

let turns = false; // about what the server finds under a double click
function turnAbout({ position }) {
  turns = false;
  if (!position || !camera) return;
  turned().target = position;
  ask(false);
}

async function copy(text, what) {
  try {
    await navigator.clipboard.writeText(text);
    say(`${what} copied`);
  } catch {
    trouble(text); // to be copied by hand
  }
}

const views = [...document.querySelectorAll("[data-view]")]; // in the order of their keys
const help = () => byId("keys").showModal();
const turning = { orbit: turned, moved: ask };
handleInput(byId("second-beads"), { ...turning, clicked: () => {}, key: () => {} });
handleInput(picture, {
  ...turning,
  clicked: (x, y) => {
    turns = false;
    // At once what the table says; the server answers with the place, the time and the line.
    const seen = answer.measuring ? -1 : own.at(x, y);
    const bead = (window.vdbviewPicked = seen < 0 ? null : own.table.describe(seen));
    if (bead) answer.show({ hit: true, bead });
    connection.send({ type: "inspect", number, x: Math.min(1, Math.max(0, x)), y: Math.min(1, Math.max(0, y)) });
  },
  key: (event) => {
    const last = state.layers[1] || controls.layerCount;
    const ofPrints = {
      t: () => motion.toggle("travels"), s: () => motion.toggle("seams"), l: () => byId("one-layer").click(), p: () => byId("play").click(),
      "[": () => controls.goTo(last - 1), "]": () => controls.goTo(last + 1),
      ",": () => motion.step(-1), ".": () => motion.step(1), "/": () => finder.open(),
    };
    const keys = {
      f: fit, m: () => setMeasuring(!answer.measuring), escape: () => setMeasuring(false), "?": help,
      ...(controls.layerCount > 0 && ofPrints),
    };
    const act = event.key in views ? () => views[event.key].click() : keys[event.key.toLowerCase()];
    act?.();
    return act !== undefined;
  },
});

for (const button of views) button.addEventListener("click", () => setView(button.dataset.view));
byId("fit").addEventListener("click", fit);
byId("help").addEventListener("click", help);
picture.addEventListener("dblclick", () => (turns = true));
byId("measure").addEventListener("click", () => setMeasuring(!answer.measuring));
byId("trouble-close").addEventListener("click", () => (byId("trouble").hidden = true));
byId("copy-command").addEventListener("click", () => copy(byId("command").textContent, "command"));
byId("copy-link").addEventListener("click", () => copy(location.href, "link"));
byId("file").addEventListener("change", () => openFile(Number(byId("file").value)));
function showPanels(shown) {
  byId("side").classList.toggle("closed", !shown);
  byId("panels").setAttribute("aria-expanded", String(shown));
}
byId("panels").addEventListener("click", () => showPanels(byId("side").classList.contains("closed")));
if (matchMedia("(max-width: 760px)").matches) showPanels((byId("legend").open = false)); // the picture first
window.addEventListener("hashchange", () => {
  const { state: view, file: linked, wrong } = fromFragment(location.hash);
  if (wrong) trouble(wrong);
  if (linked !== file) return openFile(linked, view);
  setState(view);
  controls.show();
  ask(false);
});

let resizeTimer = 0;
new ResizeObserver(() => {
  answer.draw();
  clearTimeout(resizeTimer);
  resizeTimer = setTimeout(() => {
    if (String(pixels()) !== String(shownSize)) ask(false);
  }, 120);
}).observe(picture);
/** For tests: the browser's own picture of the view with all its beads, or that of the second print, as a promise of a PNG. */
window.vdbviewDrawn = (ofSecond = false) =>
  new Promise((done) => {
    const picture = ofSecond ? second.own : own;
    picture.addEventListener("complete", () => done(picture.canvas.toDataURL()), { once: true });
    drawOwn(false);
  });
