// Beads that stand for others where those are smaller than pixels: one layer of several, and one straight bead for what goes on
// from it nearly straight; and how many straight ribbons an arc needs. Numbers, no drawing.

const NONE = 0xffffffff;
const MOST = 64; // beads that one stands for
/** Of an entry of ribbonsOf(), the bead: a table has at most so many. */
export const BEAD_BITS = 22;
const MOST_RIBBONS = 1 << (32 - BEAD_BITS);

export class CoarseBeads {
  /** One of `stride` layers, and within `tolerance`, mm. */
  constructor(table, stride, tolerance) {
    Object.assign(this, { stride, tolerance });
    this.ofBead = new Uint32Array(table.count).fill(NONE); // which one stands for it
    // The last bead that one stands for, and by that last one the first; of an arc, the number of its ribbons.
    this.ends = new Uint32Array(table.count);
    this.arcs = table.kinds.arcs && new Uint8Array(table.count); // 1: it is one
    const beads = new Uint32Array(table.count);
    let count = 0;
    for (let n = 0; n < table.count; ++n) {
      if (table.layerOf(n) % stride !== 0) continue;
      const end = lastOf(table, n, tolerance);
      beads[count++] = n;
      this.ofBead.fill(n, n, end + 1);
      this.ends[end] = n;
      this.ends[n] = end;
      const [radius, sweep] = table.arc(n);
      if (sweep) {
        // The ribbons are chords of its outer side, which is at most half of the tolerance away.
        const ribbons = Math.ceil(Math.abs(sweep) * Math.sqrt((radius + 0.5 * table.width(n)) / (4 * tolerance)));
        this.ends[n] = Math.min(Math.max(ribbons, 1), MOST_RIBBONS);
        this.arcs[n] = 1;
      }
      n = end;
    }
    this.beads = beads.slice(0, count); // those that stand for others
  }

  /** By ribbon of some of these beads: the bead, and above its BEAD_BITS which ribbon of its arc it is. */
  ribbonsOf(list) {
    const { arcs, ends } = this;
    if (!arcs) return list;
    const ribbons = new Uint32Array(list.reduce((sum, n) => sum + (arcs[n] ? ends[n] : 1), 0));
    let count = 0;
    for (const n of list) for (let part = 0; part < (arcs[n] ? ends[n] : 1); ++part) ribbons[count++] = n | (part << BEAD_BITS);
    return ribbons;
  }
}

/** The last of the beads from one on that lie within a tolerance of one straight bead. */
function lastOf(table, first, tolerance) {
  const { words, grain } = table;
  if (table.hasExtra(first)) return first;
  const at = (word, axis) => (axis ? word >>> 16 : word & 65535) * grain[axis];
  const [x, y] = [at(words[4 * first], 0), at(words[4 * first], 1)];
  const tags = words[4 * first + 3];
  let last = first;
  let length = 0;
  for (let n = first; n - first < MOST; ++n) {
    const word = words[4 * n + 3];
    if (n >= table.count || word >>> 13 !== tags >>> 13 || word & 4096 || Math.abs((word & 4095) - (tags & 4095)) > 25) break;
    if (n > first && (words[4 * n] !== words[4 * n - 3] || (words[4 * n + 2] & 65535) !== words[4 * n - 2] >>> 16)) break; // it does not go on
    const [dx, dy] = [at(words[4 * n + 1], 0) - x, at(words[4 * n + 1], 1) - y];
    const chord = Math.hypot(dx, dy);
    if (chord < length) break; // it turns back
    for (let k = first; k < n; ++k)
      if (Math.abs((at(words[4 * k + 1], 0) - x) * dy - (at(words[4 * k + 1], 1) - y) * dx) > tolerance * chord) return last;
    length = chord;
    last = n;
  }
  return last;
}
