// How large pictures are while a view moves: as large as the canvas, or, where that takes too long, as they can be in the
// time of a frame.

const SLOW = 80; // ms of a picture of full size from which on it is made smaller
const GOAL = 28; // ms of a smaller one
const STEPS = 16; // of a side
const LEAST = 4 / STEPS;

export class Pace {
  scale = 1; // of each side
  #slow = 0; // pictures of full size, one after the other

  /** The last picture took so long, ms. */
  took(time) {
    if (this.scale === 1) {
      this.#slow = time > SLOW ? this.#slow + 1 : 0;
      if (this.#slow < 2) return; // a program may have been compiled
    }
    // The time goes with the pixels at most, so that this is the least that fits; it rises slowly.
    const fits = Math.floor(this.scale * Math.sqrt(GOAL / Math.max(time, 0.1)) * STEPS) / STEPS;
    this.scale = Math.max(LEAST, Math.min(1, fits > this.scale ? this.scale + 1 / STEPS : Math.max(fits, this.scale / 2)));
    this.#slow = 0;
  }
}
