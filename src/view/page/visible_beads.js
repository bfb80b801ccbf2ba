// Which beads a picture needs. Most beads are hidden by others, and those that were seen are seen again in the next
// picture: so a picture of a moving view draws the beads that were seen, and of others those of which a point is not behind
// its surface. A quick one draws coarse beads instead, see coarse_beads.js. A view at rest adds all beads, in parts, until
// none is missing.

const [LEAST, FIRST, MOST] = [16, 64, 4096]; // beads of a part
const SHORT = 60; // ms of a part: near by, each bead may cover the picture
// Looks after which a bead that is not seen is left out: one that was seen, and one that was expected.
const FINE = { forget: 12, doubt: 2 };
const COARSE = { forget: 4, doubt: 1 };

export class VisibleBeads {
  #part = FIRST;

  constructor(beads) {
    this.all = beads;
    this.seenAt = new Uint32Array(beads); // number of the look + 1; 0: not in the list
    this.list = new Uint32Array(Math.min(beads, 4096));
    this.count = 0;
    this.look = FINE.forget + 1;
    this.coarse = null; // CoarseBeads that stand for the others
    this.restart();
  }

  /** Another picture: nothing of it is drawn yet. */
  restart() {
    this.drawn = 0;
    this.listed = this.count;
    this.#part = FIRST;
  }

  get seenBeads() {
    return this.list.subarray(0, this.count);
  }
  /** Those that were seen before are in it. */
  get begun() {
    return this.drawn >= this.listed;
  }
  get complete() {
    return this.drawn >= this.listed + this.all;
  }
  /** The next part of those that were seen, and then of all: whether it is of the former, first, count. */
  part() {
    const listed = !this.begun;
    const first = listed ? this.drawn : this.drawn - this.listed;
    const count = Math.min(this.#part, (listed ? this.listed : this.all) - first);
    this.drawn += count;
    return [listed, first, count];
  }
  /** The last part took so long, ms. */
  took(time) {
    this.#part = Math.max(LEAST, Math.min(MOST, 2 * this.#part, Math.ceil((this.#part * SHORT) / time)));
  }

  #sought = 0;

  /** The next `most` beads of a round through all, or through all coarse ones, [first, count]. */
  sought(most) {
    const all = this.coarse ? this.coarse.beads.length : this.all;
    const first = this.#sought >= all ? 0 : this.#sought;
    this.#sought = first + most;
    return [first, Math.min(most, all - first)];
  }

  /** From here on these stand for the others; null: each for itself. */
  standFor(coarse) {
    this.coarse = coarse;
    const old = this.list.slice(0, this.count);
    this.count = 0;
    this.seenAt.fill(0);
    for (const n of old) this.#add(n, this.look);
  }

  get #looks() {
    return this.coarse ? COARSE : FINE;
  }
  /** Beads that may be seen next. */
  expect(beads) {
    const { forget, doubt } = this.#looks;
    for (const n of beads) if (this.seenAt[n] === 0) this.#add(n, this.look - forget + doubt);
  }

  #add(bead, look) {
    const n = this.coarse ? this.coarse.ofBead[bead] : bead;
    if (n === 0xffffffff) return;
    if (this.seenAt[n] === 0) {
      if (this.count === this.list.length) {
        const longer = new Uint32Array(Math.min(this.all, 2 * this.list.length));
        longer.set(this.list);
        this.list = longer;
      }
      this.list[this.count++] = n;
    }
    this.seenAt[n] = Math.max(this.seenAt[n], look);
  }

  /** The pixels of a picture: bead + 1, or 0. */
  seen(ids) {
    let last = 0;
    for (let n = 0; n < ids.length; ++n) {
      const id = ids[n];
      if (id === last) continue;
      last = id;
      if (id !== 0) this.#add(id - 1, this.look);
    }
    const { forget, doubt } = this.#looks;
    if (++this.look % doubt !== 0) return;
    let kept = 0;
    for (let n = 0; n < this.count; ++n) {
      const bead = this.list[n];
      if (this.look - this.seenAt[bead] < forget) this.list[kept++] = bead;
      else this.seenAt[bead] = 0;
    }
    this.count = kept;
  }
}
