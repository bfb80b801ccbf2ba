// The beads of a print as the server streams them: 16 bytes each, and properties by run. Numbers, no drawing.
import { sub } from "./camera.js";

const asFloat = (word) => new Float32Array(Uint32Array.of(word).buffer)[0];

const LEVEL = ["solid-infill", "top-infill", "bridge", "ironing", "brim", "support-interface"];

export class BeadTable {
  /** `head` is the first message of the server: see bead_stream.h; `runs` are its bytes. */
  constructor(head, runs) {
    const { beads, low, grain, kinds, features, objects, printed, generation } = head;
    Object.assign(this, { count: beads, low, grain, kinds, features, objects, printed, generation });
    this.words = new Uint32Array(4 * beads * (kinds.extras ? 2 : 1)); // behind all beads, by bead what more belongs to it
    this.runs = new Uint32Array(runs, 0, 4 * head.runs);
    this.speeds = new Float32Array(runs, 16 * head.runs); // mm/s, by run
    this.got = 0; // beads
  }

  get complete() {
    return this.got === this.count;
  }

  /** The next part, in order. */
  add(bytes) {
    const part = new Uint32Array(bytes);
    const put = (place, from) => {
      for (let k = 0; k < 4; ++k) this.words[4 * place + k] = part[from + k];
    };
    for (let n = 0; n < part.length; n += 4) {
      put(this.got, n);
      if (this.hasExtra(this.got)) put(this.count + this.got, (n += 4));
      ++this.got;
    }
  }

  /** In the mean, mm. */
  get layerHeight() {
    return (65535 * this.grain[2]) / Math.max(1, this.layerOf(this.count - 1));
  }
  runOf(bead) {
    return this.words[4 * bead + 3] >>> 13;
  }
  layerOf(bead) {
    return this.runs[4 * this.runOf(bead) + 2];
  }

  /** The beads with layers from low to high. */
  ofLayers(low, high) {
    const beads = [];
    for (let n = 0; n < this.count; ++n) if (this.layerOf(n) >= low && this.layerOf(n) <= high) beads.push(n);
    return beads;
  }

  /** How many beads the state says are printed: a number of them, or a share. */
  end(state) {
    if (state.beads !== null) return Math.min(state.beads, this.count);
    const moments = state.by_time ? this.printed.time : this.printed.volume;
    return state.printed >= 100 ? this.count : moments[Math.max(1, Math.round(state.printed * 2)) - 1];
  }

  /** Whether the state shows nothing. */
  isEmpty(state) {
    let empty = true;
    this.each(state, () => (empty = false));
    return empty;
  }

  /** take(bead, run) of each bead that the state shows. */
  each(state, take) {
    const shown = this.shown(state);
    const end = this.end(state);
    for (let bead = 0; bead < end; ++bead) if (shown[this.runOf(bead)]) take(bead, this.runOf(bead));
  }

  /** Where a bead begins and ends, mm. */
  ends(bead) {
    const { words, low, grain } = this;
    const at = (x, y, z) => [low[0] + x * grain[0], low[1] + y * grain[1], low[2] + z * grain[2]];
    const [x, y, z] = [words[4 * bead], words[4 * bead + 1], words[4 * bead + 2]];
    return [at(x & 65535, x >>> 16, z & 65535), at(y & 65535, y >>> 16, z >>> 16)];
  }
  width(bead) {
    return (this.words[4 * bead + 3] & 4095) * 0.004;
  }
  hasExtra(bead) {
    return (this.words[4 * bead + 3] & 4096) !== 0;
  }

  /** Radius, mm, and sweep of a bead, radians; 0: it is straight. */
  arc(bead) {
    if (!this.hasExtra(bead)) return [0, 0];
    const { words, low } = this;
    const extra = 4 * (this.count + bead);
    const sweep = asFloat(words[extra + 2]);
    if (!sweep) return [0, 0];
    const [from] = this.ends(bead);
    return [Math.hypot(...[0, 1].map((axis) => asFloat(words[extra + axis]) + low[axis] - from[axis])), sweep]; // the center counts from `low`
  }

  /** Of the path of a bead, mm. */
  length(bead) {
    const [from, to] = this.ends(bead);
    const [radius, sweep] = this.arc(bead);
    return sweep ? Math.hypot(radius * sweep, to[2] - from[2]) : Math.hypot(...sub(to, from));
  }

  /** What the table knows of a bead, as the server describes it. */
  describe(bead) {
    const first = 4 * this.runOf(bead);
    const run = this.runs.subarray(first, first + 4);
    const [from, to] = this.ends(bead);
    return {
      number: bead,
      layer: run[2],
      feature: this.features[run[3] & 255],
      tool: (run[3] >>> 8) & 255,
      object: this.objects[run[3] >>> 16] || undefined,
      width_mm: this.width(bead),
      height_mm: asFloat(run[0]),
      from,
      to,
    };
  }

  /** By run: 0 where the state does not show it, 2 where its beads lie side by side, else 1. */
  shown(state) {
    const count = this.runs.length / 4;
    const shown = new Uint8Array(count);
    const [low, high] = [state.layers[0] || 1, state.layers[1] || Infinity];
    const hidden = new Set(state.hidden_features.map((name) => this.features.indexOf(name)));
    const objects = new Set(state.objects);
    const tools = new Set(state.tools);
    for (let n = 0; n < count; ++n) {
      const layer = this.runs[4 * n + 2];
      const tags = this.runs[4 * n + 3];
      if (layer < low || layer > high || hidden.has(tags & 255)) continue;
      if (objects.size && !objects.has(tags >>> 16)) continue;
      if (tools.size && !tools.has((tags >>> 8) & 255)) continue;
      shown[n] = LEVEL.includes(this.features[tags & 255]) ? 2 : 1;
    }
    return shown;
  }
}
