// The panel beside the picture: what it shows is the state, what is changed there changes the state.
import { byId, checkbox, follow, renew, setOptions } from "./elements.js";

export class Controls {
  #facts = null;
  #box = null;
  #playing = 0;

  /**
   * changed(moving) is called after each change of state(), and before it hold() where a change of what is printed must
   * not move the camera; eye() is where the camera stands, or null.
   */
  constructor({ state, changed, hold, eye }) {
    this.eye = eye;
    this.state = state;
    this.changed = changed;
    this.hold = hold;
    this.#bindLayers();
    this.#bindProgress();
    this.#bindLook();
    this.#bindLight();
    this.#bindSection();
  }

  get layerCount() {
    return this.#facts?.print?.layers ?? 0;
  }

  /** From the server: what the input has. */
  setFacts(facts) {
    this.#facts = facts;
    const print = facts.print;
    for (const group of document.querySelectorAll(".of-prints")) group.hidden = !print;
    setOptions(byId("material"), [["as the file says", ""], ["a colour", "#"], ...facts.materials.map((name) => [name, name])]);
    if (print) {
      for (const id of ["layer-low", "layer-high", "layer-from", "layer-to"]) byId(id).max = print.layers;
      this.#checks("features", print.features.map((f) => [f.name, f.name.replaceAll("-", " ")]), (list) => (this.state().hidden_features = list.off));
      this.#checks("objects", print.objects.map((o) => [o.number, o.name]), (list) => (this.state().objects = list.off.length ? list.on : []));
      this.#checks("tools", print.tools.map((t) => [t, `T${t}`]), (list) => (this.state().tools = list.off.length ? list.on : []));
      byId("objects-group").hidden = print.objects.length < 2;
      byId("tools-group").hidden = print.tools.length < 2;
    }
    const attributes = facts.attributes.map((name) => [name === "color" ? "the file's colours" : name.replace("_", " "), name]);
    setOptions(byId("color-by"), [["the material", ""], ...attributes]);
    this.show();
  }

  setBox(box) {
    this.#box = box;
    this.#showSection(this.state());
  }

  /** The state in the controls. */
  show() {
    const state = this.state();
    const count = this.layerCount;
    const low = state.layers[0] || 1;
    const high = state.layers[1] || count;
    byId("layer-low").value = byId("layer-from").value = low;
    byId("layer-high").value = byId("layer-to").value = high;
    const part = (layer) => (count > 1 ? ((layer - 1) / (count - 1)) * 100 : 0);
    byId("layer-between").style.left = `${part(low)}%`;
    byId("layer-between").style.right = `${100 - part(high)}%`;
    byId("printed").value = state.printed;
    byId("printed-value").textContent = `${state.printed} %`;
    byId("by-time").value = state.by_time ? "1" : "";
    for (const box of byId("features").querySelectorAll("input")) box.checked = !state.hidden_features.includes(box.value);
    for (const id of ["objects", "tools"])
      for (const box of byId(id).querySelectorAll("input")) box.checked = !state[id].length || state[id].includes(Number(box.value));
    byId("color-by").value = state.color_by;
    const own = state.material.startsWith("#");
    byId("material").value = own ? "#" : state.material;
    byId("color-row").hidden = !own;
    if (own) byId("color").value = state.material;
    byId("integrator").value = state.integrator;
    byId("smooth").checked = state.smooth;
    this.#showLight(state);
    this.#showSection(state);
    byId("spp").value = String(state.spp);
  }

  toggleFeature(name) {
    const hidden = this.state().hidden_features;
    this.state().hidden_features = hidden.includes(name) ? hidden.filter((each) => each !== name) : [...hidden, name];
    this.hold();
    this.show();
    this.changed(false);
  }

  #checks(id, entries, take) {
    const place = byId(id);
    const collect = () => {
      const boxes = [...place.querySelectorAll("input")];
      const value = (box) => (id === "features" ? box.value : Number(box.value));
      take({ on: boxes.filter((b) => b.checked).map(value), off: boxes.filter((b) => !b.checked).map(value) });
      this.hold();
      this.changed(false);
    };
    renew(place, ...entries.map(([value, text]) => checkbox(value, collect, text)));
  }

  /** Layers low to high of all, NaN: from the first, to the last; the ends that are those of the print are left open. */
  setLayers(low, high, moving) {
    const count = this.layerCount;
    if (!count) return;
    const within = (layer, least, open) => Math.max(least, Math.min(count, Number.isNaN(layer) ? open : Math.round(layer)));
    low = within(low, 1, 1);
    high = within(high, low, count);
    this.state().beads = null;
    this.state().layers = [low === 1 && high === count ? 0 : low, high === count ? 0 : high];
    this.hold();
    this.show();
    this.changed(moving);
  }

  /** Makes a layer the last one, or that which is shown alone. */
  goTo(layer) {
    const low = byId("one-layer").checked ? layer : Math.min(this.state().layers[0] || 1, layer);
    this.setLayers(low, layer, false);
  }

  /** Another input: what was chosen of the last one is not of this one. */
  reset() {
    this.stop();
    byId("one-layer").checked = false;
  }

  #bindLayers() {
    const [low, high, one] = ["layer-low", "layer-high", "one-layer"].map(byId);
    // A handle pushes the other one.
    follow(low, (layer, moving) => this.setLayers(layer, one.checked ? layer : Math.max(layer, Number(high.value)), moving));
    follow(high, (layer, moving) => this.setLayers(one.checked ? layer : Math.min(layer, Number(low.value)), layer, moving));
    one.addEventListener("change", () => this.setLayers(one.checked ? Number(high.value) : 1, Number(high.value), false));
    for (const id of ["layer-from", "layer-to"])
      byId(id).addEventListener("change", () => this.setLayers(byId("layer-from").valueAsNumber, byId("layer-to").valueAsNumber, false));
  }

  #bindProgress() {
    const set = (value, moving) => {
      this.state().printed = Math.round(value * 2) / 2;
      this.state().beads = null;
      this.hold();
      this.show();
      this.changed(moving);
    };
    follow(byId("printed"), set);
    byId("by-time").addEventListener("change", () => {
      this.state().by_time = byId("by-time").value !== "";
      this.hold();
      this.changed(false);
    });
    byId("play").addEventListener("click", () => (this.#playing ? this.stop() : this.#play(set)));
  }

  #play(set) {
    byId("play").setAttribute("aria-pressed", "true");
    byId("play").textContent = "❚❚";
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (this.state().printed >= 100) this.state().printed = 0.5;
    this.#playing = setInterval(() => {
      const value = Math.min(100, this.state().printed + (still ? 10 : 0.5)); // the slider may have been moved
      set(value, value < 100);
      if (value >= 100) this.stop();
    }, still ? 1500 : 100);
  }

  stop() {
    if (!this.#playing) return;
    clearInterval(this.#playing);
    this.#playing = 0;
    byId("play").setAttribute("aria-pressed", "false");
    byId("play").textContent = "▶";
    this.changed(false);
  }

  #bindLook() {
    byId("color-by").addEventListener("change", (e) => {
      this.state().color_range = null; // it was of another attribute
      this.#set("color_by", e.target.value);
    });
    byId("material").addEventListener("change", (e) => this.#set("material", e.target.value === "#" ? byId("color").value : e.target.value));
    byId("color").addEventListener("change", (e) => this.#set("material", e.target.value));
    byId("integrator").addEventListener("change", (e) => this.#set("integrator", e.target.value));
    byId("smooth").addEventListener("change", (e) => this.#set("smooth", e.target.checked));
    byId("spp").addEventListener("change", (e) => this.#set("spp", Number(e.target.value)));
  }

  #set(key, value, moving = false) {
    this.state()[key] = value;
    this.show();
    this.changed(moving);
  }

  #showLight(state) {
    const sun = state.light.startsWith("sky:");
    byId("light").value = sun ? "sky:" : state.light;
    byId("sun").hidden = !sun;
    if (sun) [byId("sun-height").value, byId("sun-turn").value] = state.light.slice(4).split(",");
    byId("light-turn").value = state.light_rotation;
    byId("own-exposure").checked = state.exposure !== null;
    byId("exposure").disabled = state.exposure === null;
    if (state.exposure !== null) byId("exposure").value = state.exposure;
    byId("bed").value = state.bed === null ? "" : state.bed ? state.bed_surface : "none";
  }

  #bindLight() {
    const sky = () => `sky:${byId("sun-height").value},${byId("sun-turn").value}`;
    byId("light").addEventListener("change", (e) => this.#set("light", e.target.value === "sky:" ? sky() : e.target.value));
    for (const id of ["sun-height", "sun-turn"]) follow(byId(id), (_, moving) => this.#set("light", sky(), moving));
    follow(byId("light-turn"), (degrees, moving) => this.#set("light_rotation", degrees, moving));
    follow(byId("exposure"), (stops, moving) => this.#set("exposure", stops, moving));
    byId("own-exposure").addEventListener("change", (e) => this.#set("exposure", e.target.checked ? Number(byId("exposure").value) : null));
    byId("bed").addEventListener("change", (e) => {
      const value = e.target.value;
      this.state().bed = value === "" ? null : value !== "none";
      this.#set("bed_surface", value === "none" ? "" : value);
    });
  }

  /** The plane that the controls say, or null. */
  #section() {
    if (!byId("cut").checked || !this.#box) return null;
    const axis = Number(byId("cut-axis").value);
    const [low, high] = [this.#box[axis], this.#box[axis + 3]];
    const at = Math.round((low + ((high - low) * Number(byId("cut-at").value)) / 1000) * 1000) / 1000;
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

  #bindSection() {
    const take = (moving = false) => this.#set("clip", this.#section(), moving);
    // A new cut faces the camera.
    const face = () => {
      const eye = this.eye();
      const axis = Number(byId("cut-axis").value);
      if (eye && this.#box) byId("cut-flip").checked = eye[axis] < (this.#box[axis] + this.#box[axis + 3]) / 2;
      take();
    };
    for (const id of ["cut", "cut-axis"]) byId(id).addEventListener("change", face);
    byId("cut-flip").addEventListener("change", () => take());
    follow(byId("cut-at"), (_, moving) => take(moving));
  }
}
