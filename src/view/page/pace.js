// How pictures are drawn while a view moves: as at rest, or, where that takes too long, quickly, and as large as they can be in
// the time of a frame.

const SLOW = 80; // ms of a picture as at rest from which on they are drawn quickly
const GOAL = 30; // ms of a quick one
const START = 0.5; // of each side, of the first quick one
const FAST = 5; // ms of a quick one of full size from which on they are drawn as at rest again
const STEPS = 16; // of a side
const LEAST = 4 / STEPS;
const WAIT = 60; // quick ones until a size that was too slow is tried again

export class Pace {
  scale = 1; // of each side
  quick = false;
  fast = false; // a picture as at rest is known not to be slow
  known = false; // whether they are slow or not
  #slow = 0; // of pictures as at rest, one after the other
  #last = 0; // ms of the last quick one
  #large = 1; // a size that was too slow
  #wait = 0;
  #calm = 0; // quick ones that were in time

  /** A part of a picture at rest took so long, ms. `begins`: it is the first, which has all that was seen before. */
  rested(time, begins = true) {
    if (this.quick) return;
    if (begins) this.fast = time <= SLOW;
    this.#slow = time > SLOW ? this.#slow + 1 : 0;
    this.#choose(this.#slow >= 2); // once, a program may have been compiled
  }
  /** A whole one as at rest takes so long, ms. */
  measured(time) {
    this.fast = time <= SLOW;
    this.#choose(!this.fast);
  }
  #choose(quick) {
    this.quick = quick;
    this.known ||= quick || this.fast;
    if (quick) this.scale = START;
  }
  /** A moving picture took so long, ms. */
  took(time) {
    if (!this.quick) return this.rested(time);
    this.quick = this.scale < 1 || time > FAST;
    this.#slow = 0;
    this.#fit(Math.min(time, this.#last)); // it gets smaller if two in a row were slow
    this.#last = time;
  }
  // The time goes with the pixels at most: the size that follows from that fits. But a part of the time has nothing to do with
  // them, so that a larger size may fit, too: it is tried, and for a while not again where it was too slow.
  #fit(time) {
    --this.#wait;
    if (time > GOAL) {
      [this.#large, this.#wait] = [this.scale, WAIT];
      const fits = Math.floor(this.scale * Math.sqrt(GOAL / time) * STEPS) / STEPS;
      this.scale = Math.max(LEAST, fits, this.scale / 2);
    } else if (this.scale < 1 && ++this.#calm % 2 === 0) {
      const larger = this.scale + 1 / STEPS;
      if (this.#wait < 0 || larger < this.#large || time < GOAL / 4) this.scale = larger;
    }
  }
}
