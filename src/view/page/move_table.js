// Travels, seams and the like as the server streams them: 32 bytes each, see move_stream.h. Numbers, no drawing.

/** By kind: the name, and the colour of its lines or marks. */
export const KINDS = [
  ["travels", "#4f86c6"], ["wipes", "#d9a520"], ["retractions", "#b13cc4"], ["recoveries", "#3fa63f"],
  ["seams", "#f2f2f2"], ["tool changes", "#e0452a"], ["pauses", "#f07f13"], ["filament changes", "#1fb8b0"],
];
/** Bits of the kinds that are lines. */
export const LINES = 3;

export class MoveTable {
  /** `beads`: the table of the same print. */
  constructor({ count, generation }, beads) {
    Object.assign(this, { count, generation, beads });
    this.words = new Uint32Array(8 * count);
    this.begins = new Uint8Array(count); // 0: it goes on with the one before it
    this.totals = KINDS.map(() => 0);
    this.got = 0;
  }

  get complete() {
    return this.got === this.count;
  }

  /** The next part, in order. */
  add(bytes) {
    const { words, beads } = this;
    const part = new Uint32Array(bytes);
    words.set(part, 8 * this.got);
    for (const end = this.got + part.length / 8; this.got < end; ++this.got) {
      const word = words[8 * this.got + 7];
      this.begins[this.got] = word >>> 31 ? 0 : 1;
      this.totals[(word >>> 28) & 7] += this.begins[this.got];
      // What leads to a bead is of its layer; what comes behind the last bead, of that one's.
      const layer = beads.layerOf(Math.min(beads.count - 1, words[8 * this.got + 6]));
      words[8 * this.got + 7] = (word & 0x70000000) | layer;
    }
  }

  /** How many of each kind these layers have before a number of beads; as the shader selects. */
  counts([low, high], end) {
    const counts = KINDS.map(() => 0);
    for (let n = 0; n < this.count; ++n) {
      const word = this.words[8 * n + 7];
      const layer = word & 0xfffffff;
      if (this.begins[n] && layer >= low && layer <= high && this.words[8 * n + 6] < end) ++counts[word >>> 28];
    }
    return counts;
  }
}
