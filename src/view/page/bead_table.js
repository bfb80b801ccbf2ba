// The beads of a print as the server streams them: 16 bytes each, and properties by run. Numbers, no drawing.
import { sub } from "./camera.js";

/** The least number from 0 to `count` for which it is true; once true, it stays so. */
function leastThat(isTrue, count) {
  let [low, high] = [0, count];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (isTrue(middle)) high = middle;
    else low = middle + 1;
  }
  return low;
}

const asFloat = (word) => new Float32Array(Uint32Array.of(word).buffer)[0];

export class BeadTable {
  /** `head` is the first message of the server: see bead_table.h; `runs` are its bytes. */
  constructor(head, runs) {
    const { texels, low, grain, kinds, features, objects, printed, generation } = head;
    Object.assign(this, { texels, low, grain, kinds, features, objects, printed, generation });
    this.words = new Uint32Array(4 * texels);
    this.runs = new Uint32Array(runs, 0, 4 * head.runs);
    this.speeds = new Float32Array(runs, 16 * head.runs); // mm/s, by run
    this.got = 0; // texels
    this.extras = []; // texels that belong to the bead before them, ascending
  }

  get complete() {
    return this.got === this.texels;
  }

  /** The next part, in order. */
  add(bytes) {
    const part = new Uint32Array(bytes);
    this.words.set(part, 4 * this.got);
    const end = this.got + part.length / 4;
    if (this.kinds.extras)
      for (let n = this.got; n < end; ++n)
        if (n > 0 && this.words[4 * n - 1] & 4096 && this.extras.at(-1) !== n - 1) this.extras.push(n);
    this.got = end;
  }

  /** The number of a texel's bead, and the other way round: a bead and its extra are one. */
  beadOf(texel) {
    return texel - leastThat((n) => this.extras[n] >= texel, this.extras.length);
  }
  texelOf(bead) {
    return this.extras.length ? leastThat((texel) => this.beadOf(texel + 1) > bead, this.texels) : bead;
  }

  /** In the mean, mm. */
  get layerHeight() {
    return (65535 * this.grain[2]) / Math.max(1, this.layerOf(this.texels - 1));
  }
  layerOf(texel) {
    return this.runs[4 * (this.words[4 * texel + 3] >>> 13) + 2];
  }

  /** Parts [first, end] of the texels with layers from low to high. */
  ofLayers(low, high) {
    const parts = [];
    for (let n = 0; n < this.texels; ++n) {
      const layer = this.layerOf(n);
      if (layer < low || layer > high) continue;
      const last = parts.at(-1);
      if (last && last[1] === n) last[1] = n + 1;
      else parts.push([n, n + 1]);
    }
    return parts;
  }

  /** Values by bead as values by texel. */
  byTexel(values) {
    if (!this.extras.length) return values;
    const result = new values.constructor(this.texels);
    let next = 0;
    for (let texel = 0, bead = -1; texel < this.texels; ++texel) {
      if (this.extras[next] === texel) ++next;
      else ++bead;
      result[texel] = values[bead];
    }
    return result;
  }

  /** Texels from, to of what the state says is printed: a number of beads, or a share. */
  range(state) {
    if (state.beads !== null) return [0, this.texelOf(state.beads)];
    const moments = state.by_time ? this.printed.time : this.printed.volume;
    const end = state.printed >= 100 ? this.texels : this.texelOf(moments[Math.max(1, Math.round(state.printed * 2)) - 1]);
    return [0, end];
  }

  /** take(texel, run) of each bead that the state shows. */
  each(state, take) {
    const shown = this.shown(state);
    const [first, end] = this.range(state);
    for (let texel = first; texel < end; ++texel) {
      const run = this.words[4 * texel + 3] >>> 13;
      if (shown[run]) take(texel, run);
      if (this.hasExtra(texel)) ++texel;
    }
  }

  /** Where a bead begins and ends, mm. */
  ends(texel) {
    const { words, low, grain } = this;
    const at = (x, y, z) => [low[0] + x * grain[0], low[1] + y * grain[1], low[2] + z * grain[2]];
    const [x, y, z] = [words[4 * texel], words[4 * texel + 1], words[4 * texel + 2]];
    return [at(x & 65535, x >>> 16, z & 65535), at(y & 65535, y >>> 16, z >>> 16)];
  }
  width(texel) {
    return (this.words[4 * texel + 3] & 4095) * 0.004;
  }
  hasExtra(texel) {
    return (this.words[4 * texel + 3] & 4096) !== 0;
  }

  /** Of the path of a bead, mm. */
  length(texel) {
    const [from, to] = this.ends(texel);
    const sweep = this.hasExtra(texel) ? asFloat(this.words[4 * texel + 6]) : 0;
    if (!sweep) return Math.hypot(...sub(to, from));
    // The center counts from the corner of the table.
    const radius = Math.hypot(...[0, 1].map((axis) => asFloat(this.words[4 * texel + 4 + axis]) + this.low[axis] - from[axis]));
    return Math.hypot(radius * sweep, to[2] - from[2]);
  }

  /** What the table knows of a bead, as the server describes it. */
  describe(texel) {
    const first = 4 * (this.words[4 * texel + 3] >>> 13);
    const run = this.runs.subarray(first, first + 4);
    const [from, to] = this.ends(texel);
    return {
      number: this.beadOf(texel),
      layer: run[2],
      feature: this.features[run[3] & 255],
      tool: (run[3] >>> 8) & 255,
      object: this.objects[run[3] >>> 16] || undefined,
      width_mm: this.width(texel),
      height_mm: asFloat(run[0]),
      from,
      to,
    };
  }

  /** By run: 1 where the state shows it. */
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
      shown[n] = 1;
    }
    return shown;
  }
}
