// Which beads a picture needs. Most beads are hidden by others, and those that were seen are seen again in the next
// picture: so a picture of a moving view draws the beads that were seen, and each time another part of all others, from
// which the pixels tell what has come into sight. A view at rest adds the parts until none is missing.

const PART = 16384; // beads
const FORGET = 90; // pictures after which a bead that is not seen is left to the parts again

export class VisibleBeads {
  constructor(texels) {
    this.texels = texels;
    this.seenAt = new Uint16Array(texels); // number of the look + 1; 0: not in the list
    this.list = new Uint32Array(Math.min(texels, 4096));
    this.count = 0;
    this.changedFrom = 0; // the list's texture is right up to here
    this.look = 1;
    this.restart();
  }


  /** Another picture: nothing of it is drawn yet. */
  restart() {
    this.partsLeft = Math.ceil(this.texels / PART);
  }
  #next = 0;

  /** The next part of all beads, [first, count], or null if all are in the picture. */
  part() {
    if (this.partsLeft === 0) return null;
    --this.partsLeft;
    const first = this.#next * PART >= this.texels ? 0 : this.#next * PART;
    this.#next = first / PART + 1;
    return [first, Math.min(PART, this.texels - first)];
  }

  /** Beads that may be seen next, by texel. */
  expect(first, end) {
    for (let n = first; n < end; ++n) this.#add(n);
  }

  #add(n) {
    if (this.seenAt[n] === 0) {
      if (this.count === this.list.length) {
        const longer = new Uint32Array(Math.min(this.texels, 2 * this.list.length));
        longer.set(this.list);
        this.list = longer;
      }
      this.list[this.count++] = n;
    }
    this.seenAt[n] = this.look;
  }

  /** The pixels of a picture: texel + 1, or 0. */
  seen(ids) {
    let last = 0;
    for (let n = 0; n < ids.length; ++n) {
      const id = ids[n];
      if (id === last) continue;
      last = id;
      if (id !== 0) this.#add(id - 1);
    }
    if (++this.look % FORGET !== 0) return;
    let kept = 0;
    for (let n = 0; n < this.count; ++n) {
      const texel = this.list[n];
      if (this.look - this.seenAt[texel] < FORGET) this.list[kept++] = texel;
      else this.seenAt[texel] = 0;
    }
    this.count = kept;
    this.changedFrom = 0;
    if (this.look < 65000) return;
    for (let n = 0; n < kept; ++n) this.seenAt[this.list[n]] = 1;
    this.look = 2;
  }
}
