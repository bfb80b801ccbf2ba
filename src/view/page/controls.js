// The panel beside the picture: what it shows is the state, what is changed there changes the state.
import { roundedTo } from "./camera.js";
import { byId, checkbox, follow, renew, setOptions, setValue } from "./elements.js";

export class Controls {
  #facts = null;
  #box = null;
  #playing = 0;

  /** page: see main.js. */
  constructor(page) {
    this.page = page;
    const takes = { ...this.#takeSelection(), ...this.#takeLook(), ...this.#takeSection() };
    for (const [id, take] of Object.entries(takes)) follow(byId(id), take);
    byId("play").addEventListener("click", () => (this.#playing ? this.stop() : this.#play()));
    page.connection.on("facts", ({ facts }) => this.#setFacts(facts));
    page.connection.on("scene", ({ box }) => {
      this.#box = box;
      this.#showSection(page.state);
    });
  }

  get layerCount() {
    return this.#facts?.print?.layers ?? 0;
  }

  /** What the input has. */
  #setFacts(facts) {
    const { print } = facts;
    for (const group of document.querySelectorAll(".of-prints")) group.hidden = !print;
    setOptions(byId("material"), [["as the file says", ""], ["a colour", "#"], ...facts.materials.map((name) => [name, name])]);
    const anew = this.#facts?.print && this.#facts.generation !== facts.generation;
    this.#facts = facts;
    if (print) {
      if (anew) this.#fitSelection(print);
      for (const id of ["layer-low", "layer-high", "layer-from", "layer-to"]) byId(id).max = print.layers;
      // The file may have been written anew, with fewer.
      const [low, high] = this.page.state.layers;
      if (Math.max(low, high) > print.layers) this.page.change({ layers: low > print.layers ? [0, 0] : [low, 0] });
      // No number means all of them: the last one stays.
      const some = (key) => (on, off) => (on.length ? { [key]: off.length ? on : [] } : {});
      this.#checks("features", print.features.map((f) => [f.name, f.name.replaceAll("-", " ")]), (on, off) => ({ hidden_features: off }));
      this.#checks("objects", print.objects.map((o) => [o.number, o.name]), some("objects"));
      this.#checks("tools", print.tools.map((t) => [t, `T${t}`]), some("tools"));
      byId("objects-group").hidden = print.objects.length < 2;
      byId("tools-group").hidden = print.tools.length < 2;
    }
    const attributes = facts.attributes.map((name) => [name === "color" ? "the file's colours" : name.replace("_", " "), name]);
    setOptions(byId("color-by"), [["the material", ""], ...attributes]);
    this.show();
  }

  /** What is selected of a print that was written anew: a number of beads is of the old one, and what it has no more hides nothing. */
  #fitSelection({ features, objects, tools }) {
    const { state } = this.page;
    const of = (chosen, all) => chosen.filter((each) => all.includes(each));
    const hidden_features = features.every(({ name }) => state.hidden_features.includes(name)) ? [] : state.hidden_features;
    this.page.change({ beads: null, hidden_features, objects: of(state.objects, objects.map((o) => o.number)), tools: of(state.tools, tools) });
  }

  /** Of an error of the server: why nothing is selected, in the words of the page; "": it is another error. */
  whyNothing(error) {
    if (error.includes("nothing of what is selected is printed")) return "what is selected is printed later";
    const { hidden_features, layers, objects, tools } = this.page.state;
    const here = layers.some(Boolean) || [...hidden_features, ...objects, ...tools].length > 0; // not on the command line
    if (!here || !error.startsWith("no bead is left")) return "";
    const any = byId("features").querySelector("input:checked");
    return any ? "these layers have nothing of the features, objects and tools that are ticked" : "all features are hidden";
  }

  /** A list of boxes for pairs of value and text; of what is on and off, change() makes a part of the state. */
  #checks(id, entries, change) {
    const of = (on) => entries.filter((_, n) => byId(id).children[n].control.checked === on).map(([value]) => value);
    const changed = () => this.page.select(change(of(true), of(false)));
    renew(byId(id), ...entries.map(([value, text]) => checkbox(value, changed, text)));
  }

  /** The state in the controls. */
  show() {
    const { state } = this.page;
    const count = this.layerCount;
    const [low, high] = [state.layers[0] || 1, state.layers[1] || count];
    const part = (layer) => (count > 1 ? ((layer - 1) / (count - 1)) * 100 : 0);
    byId("layer-between").style.left = `${part(low)}%`;
    byId("layer-between").style.right = `${100 - part(high)}%`;
    for (const box of byId("features").querySelectorAll("input")) box.checked = !state.hidden_features.includes(box.value);
    for (const id of ["objects", "tools"])
      for (const box of byId(id).querySelectorAll("input")) box.checked = !state[id].length || state[id].includes(Number(box.value));
    const own = state.material.startsWith("#");
    byId("color-row").hidden = !own;
    const [height, turn] = state.light.startsWith("sky:") ? state.light.slice(4).split(",") : [];
    byId("sun").hidden = !turn;
    byId("exposure").disabled = state.exposure === null;
    const values = {
      "layer-low": low, "layer-from": low, "layer-high": high, "layer-to": high,
      "one-layer": state.one_layer && low === high, printed: state.printed, "by-time": state.by_time ? "1" : "",
      "color-by": state.color_by, material: own ? "#" : state.material, ...(own && { color: state.material }),
      integrator: state.integrator, smooth: state.smooth, spp: state.spp,
      light: turn ? "sky:" : state.light, ...(turn && { "sun-height": height, "sun-turn": turn }), "light-turn": state.light_rotation,
      "own-exposure": state.exposure !== null, ...(state.exposure !== null && { exposure: state.exposure }),
      bed: state.bed === null ? "" : state.bed ? state.bed_surface : "none",
    };
    for (const [id, value] of Object.entries(values)) setValue(byId(id), value);
    this.#showSection(state);
  }

  /** Layers low to high of all, NaN: from the first, to the last; the ends that are those of the print are left open. */
  setLayers(low, high, moving) {
    const { checked } = byId("one-layer");
    const count = this.layerCount;
    if (!count) return;
    const within = (layer, least, open) => Math.max(least, Math.min(count, Number.isNaN(layer) ? open : Math.round(layer)));
    low = within(low, 1, 1);
    high = within(high, low, count);
    this.page.select({ beads: null, one_layer: checked && low === high, layers: [low === 1 && high === count ? 0 : low, high === count ? 0 : high] }, moving);
  }

  /** Makes a layer the last one, or that which is shown alone. */
  goTo(layer) {
    const low = byId("one-layer").checked ? layer : Math.min(this.page.state.layers[0] || 1, layer);
    this.setLayers(low, layer);
  }

  /** Another input. */
  reset() {
    this.stop();
    this.#facts = null;
  }

  #takeSelection() {
    const [low, high, one, from, to] = ["layer-low", "layer-high", "one-layer", "layer-from", "layer-to"].map(byId);
    const typed = () => this.setLayers(from.valueAsNumber, to.valueAsNumber);
    return {
      // A handle pushes the other one.
      "layer-low": (layer, moving) => this.setLayers(layer, one.checked ? layer : Math.max(layer, high.valueAsNumber), moving),
      "layer-high": (layer, moving) => this.setLayers(one.checked ? layer : Math.min(layer, low.valueAsNumber), layer, moving),
      "one-layer": (on) => this.setLayers(on ? high.valueAsNumber : 1, high.valueAsNumber),
      "layer-from": typed,
      "layer-to": typed,
      printed: (printed, moving) => this.page.select({ printed, beads: null }, moving),
      "by-time": (value) => this.page.select({ by_time: value !== "" }),
    };
  }

  #play() {
    this.#showPlaying(true);
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (this.page.state.printed >= 100) this.page.state.printed = 0.5;
    this.#playing = setInterval(() => {
      const printed = Math.min(100, this.page.state.printed + (still ? 10 : 0.5)); // the slider may have been moved
      this.page.select({ printed, beads: null }, printed < 100);
      if (printed >= 100) this.stop();
    }, still ? 1500 : 100);
  }

  stop() {
    if (!this.#playing) return;
    clearInterval(this.#playing);
    this.#playing = 0;
    this.#showPlaying(false);
    this.page.ask(false);
  }

  #showPlaying(on) {
    byId("play").setAttribute("aria-pressed", String(on));
    byId("play").textContent = on ? "❚❚" : "▶";
  }

  #takeLook() {
    const change = (...of) => this.page.change(...of);
    const sky = () => `sky:${byId("sun-height").value},${byId("sun-turn").value}`;
    const sun = (_, moving) => change({ light: sky() }, moving);
    return {
      "color-by": (name) => change({ color_by: name, color_range: null }), // which was of another attribute
      material: (name) => change({ material: name === "#" ? byId("color").value : name }),
      color: (material) => change({ material }),
      integrator: (integrator) => change({ integrator }),
      smooth: (smooth) => change({ smooth }),
      spp: (value) => change({ spp: Number(value) }),
      light: (light) => change({ light: light === "sky:" ? sky() : light }),
      "sun-height": sun,
      "sun-turn": sun,
      "light-turn": (light_rotation, moving) => change({ light_rotation }, moving),
      exposure: (exposure, moving) => change({ exposure }, moving),
      "own-exposure": (on) => change({ exposure: on ? byId("exposure").valueAsNumber : null }),
      bed: (value) => change({ bed: value === "" ? null : value !== "none", bed_surface: value === "none" ? "" : value }),
    };
  }

  #takeSection() {
    const take = (_, moving) => this.page.change({ clip: this.#section() }, moving);
    // A new cut faces the camera.
    const face = () => {
      const axis = Number(byId("cut-axis").value);
      const { camera } = this.page;
      if (camera && this.#box) byId("cut-flip").checked = camera.eye[axis] < (this.#box[axis] + this.#box[axis + 3]) / 2;
      take();
    };
    return { cut: face, "cut-axis": face, "cut-flip": take, "cut-at": take };
  }

  /** The plane that the controls say, or null. */
  #section() {
    if (!byId("cut").checked || !this.#box) return null;
    const axis = Number(byId("cut-axis").value);
    const [low, high] = [this.#box[axis], this.#box[axis + 3]];
    const at = roundedTo(high - low || 1, low + ((high - low) * byId("cut-at").valueAsNumber) / 1000);
    const sign = byId("cut-flip").checked ? -1 : 1;
    const clip = [0, 0, 0, sign * at];
    clip[axis] = sign;
    return clip;
  }

  #showSection({ clip }) {
    byId("cut").checked = clip !== null;
    if (!clip || !this.#box || String(clip) === String(this.#section())) return;
    const axis = [0, 1, 2].reduce((a, b) => (Math.abs(clip[b]) > Math.abs(clip[a]) ? b : a));
    const [low, high] = [this.#box[axis], this.#box[axis + 3]];
    byId("cut-axis").value = String(axis);
    byId("cut-flip").checked = clip[axis] < 0;
    byId("cut-at").value = (1000 * (clip[3] / clip[axis] - low)) / (high - low);
  }
}
