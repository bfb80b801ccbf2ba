// The picture that this browser draws itself while anything moves; the server's finished one fades in over it.
import { BeadRenderer } from "./bead_renderer.js";
import { BeadTable } from "./bead_table.js";
import { BED_TINTS, EXCLUDED_TINTS, bedLines } from "./bed.js";
import { KINDS, MoveTable } from "./move_table.js";
import { pixelRatio } from "./elements.js";
import { Pace } from "./pace.js";
import { release } from "./webgl.js";

const ALL = 0xffffffff;
const NOT_HERE = "the beads are not here yet";
const FEW = 200000; // beads that can be sought in a picture whatever draws them; of a million that takes half a second without a GPU
const STEP = 30; // ms of a picture at rest after which others may have their turn
const tints = KINDS.map(([, hex]) => [1, 3, 5].map((n) => parseInt(hex.slice(n, n + 2), 16) / 255));

export class OwnPicture extends EventTarget {
  table = null;
  moves = null; // the MoveTable
  bed = null;
  why = NOT_HERE; // there is no own picture
  #connection = null;
  #generation; // of the input's file
  #movesAsked = false;
  #renderer = null;
  #look = null;
  #colors = null;
  #values = [];
  #over = null; // see paintOver()
  #key = ""; // of the selection that the renderer has
  #shown = null; // of the moves: layers, end
  #counted = {};
  #frame = 0;
  #resting = null; // camera, state and size of a picture that is not complete yet
  #litAt = 0; // when a part of it was shown, if the next one has not begun yet
  #due = 0; // when it may be shown again
  #frames = 0; // of those that move
  #pace = new Pace();

  /** Events: "changed" when `ready` or `why` have changed; "complete" when a picture at rest has all its beads; "moves"
   * when `moves` has become complete. */
  constructor(canvas) {
    super();
    this.canvas = canvas;
    canvas.addEventListener("webglcontextlost", (event) => {
      event.preventDefault();
      this.#stop("the browser has lost its GPU");
    });
    canvas.addEventListener("webglcontextrestored", () => this.#start());
  }

  get ready() {
    return this.#renderer !== null && this.#look !== null;
  }

  // ---------------------------------------------------------------- from the server

  /** Asks a connection for what it draws, also when the server is back and when the file was written anew. */
  listen(connection) {
    this.#connection = connection;
    this.#generation = undefined;
    this.refuse(NOT_HERE);
    connection.on("hello", () => connection.send({ type: "beads" }));
    connection.on("facts", ({ facts }) => {
      if (![undefined, facts.generation].includes(this.#generation)) connection.send({ type: "beads" });
      this.#generation = facts.generation;
    });
    connection.on("beads", (head) => this.#begin(head));
    connection.on("bead-part", (part) => this.#add(part));
    connection.on("no-beads", ({ text }) => this.refuse(text));
    connection.on("colors", (colors) => this.#paint(colors));
    connection.on("moves", (head) => this.#beginMoves(head));
    connection.on("move-part", (part) => this.#addMoves(part));
    connection.on("no-moves", () => (this.#movesAsked = false));
  }
  /** Another input was opened. */
  open() {
    if (!this.#connection) return;
    this.#generation = undefined;
    this.refuse(NOT_HERE);
    this.#connection.send({ type: "beads" });
  }
  #begin(head) {
    this.refuse("the beads are on their way");
    this.table = new BeadTable(head, head.file);
    this.#look = this.#colors = this.#over = null;
  }
  #add({ generation, file }) {
    if (this.table === null || generation !== this.table.generation) return;
    this.table.add(file);
    if (this.table.complete) this.#start();
  }
  /** There will be none. */
  refuse(why) {
    this.table = this.moves = null;
    this.#movesAsked = false;
    this.#stop(why);
  }
  /** Of the program: travels and marks. */
  #beginMoves(head) {
    this.moves = this.table?.complete && head.generation === this.table.generation ? new MoveTable(head, this.table) : null;
    if (head.count === 0) this.#takeMoves();
  }
  #addMoves({ generation, file }) {
    if (this.moves?.generation !== generation) return;
    this.moves.add(file);
    if (this.moves.complete) this.#takeMoves();
  }
  #takeMoves() {
    if (!this.moves?.complete) return;
    if (this.moves.count) this.#renderer?.lines.set("moves", { table: this.moves.words, tints });
    this.#tell("moves");
  }
  /** Corners of the printer's bed, or null; and of the areas of it that stay free. */
  setBed(corners, excluded = []) {
    this.bed = corners;
    this.excluded = excluded;
    this.#renderer?.lines.set("bed", corners && { table: bedLines([corners], 10), tints: BED_TINTS });
    this.#renderer?.lines.set("excluded", excluded.length ? { table: bedLines(excluded, 2), tints: EXCLUDED_TINTS } : null);
  }
  /** `values` of the attribute by colour. */
  #paint({ palette, values, file }) {
    if (!this.table) return;
    const places = new Uint16Array(file);
    this.#values = values;
    this.#colors = places.length ? [places, palette] : [null, null];
    if (!this.#over) this.#renderer?.paint(...this.#colors);
  }
  /** Other colours for a while, as places by bead and a palette; null: its own again. */
  paintOver(colors) {
    this.#over = colors;
    this.#renderer?.paint(...(colors ?? this.#colors ?? [null, null]));
  }
  /** How much of what is shown has values in each of `count` even parts from least to most: mm, or seconds at the
   * programmed speeds. What lies beyond is in the parts at the ends. Null: not known here. */
  histogram(state, least, most, count, by_time) {
    if (!this.ready || !this.#colors?.[0] || !(most > least)) return null;
    const parts = this.#values.map((value) => (value === null ? -1 : Math.max(0, Math.min(count - 1, Math.floor(((value - least) / (most - least)) * count)))));
    const sums = new Array(count).fill(0);
    this.table.each(state, (bead, run) => {
      const part = parts[this.#colors[0][bead]];
      if (part >= 0) sums[part] += this.table.length(bead) / (by_time ? this.table.speeds[run] || Infinity : 1);
    });
    return sums;
  }
  /** Where the nozzle is if a part of the print is shown that ends within its layers; else null. */
  head(state) {
    if (!this.ready || (state.beads === null && state.printed >= 100)) return null;
    const bead = this.table.end(state) - 1;
    if (bead < 0) return null;
    const { layer, to } = this.table.describe(bead);
    return layer >= state.layers[0] && layer <= (state.layers[1] || Infinity) ? to : null;
  }
  illuminate(look) {
    this.#look = { ...this.#look, ...look };
    if (!this.#renderer) return;
    this.#renderer.illuminate(this.#look);
    this.#tell("changed");
  }

  #tell(type) {
    this.dispatchEvent(new Event(type));
  }
  #stop(why) {
    cancelAnimationFrame(this.#frame);
    this.#frame = 0;
    this.#renderer?.release();
    this.#renderer = null;
    this.why = why;
    this.#tell("changed");
  }
  #start() {
    if (!this.table?.complete) return;
    try {
      this.#renderer = new BeadRenderer(this.canvas, this.table);
    } catch (error) {
      const gl = this.canvas.getContext("webgl2");
      if (gl) release(gl); // what was made before
      return this.#stop(error.message);
    }
    this.#key = "";
    this.why = "";
    this.#renderer.paint(...(this.#over ?? this.#colors ?? [null, null]));
    if (this.#look) this.#renderer.illuminate(this.#look);
    if (this.bed) this.setBed(this.bed, this.excluded);
    this.#takeMoves();
    this.#tell("changed");
  }

  // ---------------------------------------------------------------- pictures

  /** At once; a picture at rest is completed in the next frames. */
  draw(camera, state, size, moving) {
    const renderer = this.#renderer;
    cancelAnimationFrame(this.#frame);
    this.#frame = 0;
    const scale = moving ? this.#pace.scale : 1;
    const [width, height] = size.map((side) => Math.max(1, Math.round(side * scale)));
    if (moving && this.#pace.quick) renderer.coarseFor(camera, state, height);
    renderer.resize(width, height);
    this.#select(state);
    this.#selectLines(state, scale);
    const { quick } = this.#pace;
    this.#resting = { camera, state, quick };
    if (moving) return this.#drawMoving(camera, state);
    if (quick) renderer.drawQuick(camera, state); // stays until all beads are in the better one
    this.#complete(true);
  }
  /** The picture at rest, by parts of its beads: what waits would hold up the next picture that moves. */
  #complete(anew) {
    const renderer = this.#renderer;
    const { visible } = renderer;
    const { camera, state, quick } = this.#resting;
    const began = performance.now();
    const waited = !anew && visible.begun;
    renderer.finish(); // what waits is not of the first part
    let [done, start, now] = [false, anew, performance.now()];
    // To show a part may take ten times as long as to draw it: a quarter of the time is for that.
    if (anew) this.#due = 0;
    else if (this.#litAt) this.#due = now + 3 * (now - this.#litAt);
    this.#litAt = 0;
    do {
      const before = now;
      done = renderer.collect(camera, state, 1, start);
      start = false;
      renderer.finish();
      now = performance.now();
      visible.took(now - before);
    } while (!done && now - began < STEP);
    if (done || (visible.begun && !quick && now >= this.#due)) {
      renderer.light(camera, state);
      this.#litAt = performance.now();
    }
    if (done || (visible.begun && !waited)) renderer.note();
    this.#pace.rested(performance.now() - began, anew);
    this.#frame = requestAnimationFrame(() => (done ? this.#prepare() : this.#complete(false)));
    if (done) this.#tell("complete");
  }
  /** After a picture at rest: whether the next ones that move are to be quick ones, and what these need. */
  #prepare() {
    this.#frame = 0;
    const { camera, state } = this.#resting;
    if (!this.#pace.known) {
      const began = performance.now();
      this.#renderer.collect(camera, state, 0, true); // the same picture, by programs that are compiled now
      this.#renderer.light(camera, state);
      this.#renderer.finish();
      this.#pace.measured(performance.now() - began);
    }
    if (this.#pace.quick) this.#renderer.prepareQuick(camera, state);
  }
  #drawMoving(camera, state) {
    const began = performance.now();
    const renderer = this.#renderer;
    const { quick } = this.#pace;
    const turn = this.#frames++ % 4;
    if (!quick) renderer.drawAllBeads();
    const bounded = quick || this.#pace.fast || this.table.count <= FEW;
    const seek = bounded && renderer.hasMoved(camera);
    if (quick) renderer.drawQuick(camera, state, turn === 0, seek);
    else {
      renderer.collect(camera, state, 0, true, seek);
      renderer.light(camera, state);
    }
    if (turn === 0) renderer.note();
    else if (turn === 2) renderer.lookFor(quick ? 2 : 32);
    else if (!quick) return;
    if (quick) renderer.finish();
    this.#pace.took(performance.now() - began - (seek ? renderer.seekTime : 0)); // as many pixels as without
  }
  /** Pixels of the last picture. */
  get size() {
    return this.#renderer.size;
  }
  /** The lines of the last picture alone, see LineRenderer. */
  lines() {
    return this.#renderer?.lines.alone() ?? null;
  }
  #selectLines(state, scale) {
    const { lines } = this.#renderer;
    const kinds = KINDS.reduce((bits, [name], n) => bits | (state.also.includes(name) ? 1 << n : 0), 0);
    if (kinds && !this.#movesAsked) this.#connection.send({ type: "moves" }); // when they are first wanted
    this.#movesAsked ||= kinds > 0;
    const end = this.table.end(state);
    this.#shown = { layers: [state.layers[0] || 1, state.layers[1] || ALL >>> 4], end: end < this.table.count ? end : ALL };
    if (lines.sets.has("moves")) lines.set("moves", { ...this.#shown, kinds, point: 7 * pixelRatio() * scale });
    const bed = { layers: [0, 0], end: ALL, kinds: state.also.some((name) => name.startsWith("bed")) ? 3 : 0, point: 0 };
    for (const name of ["bed", "excluded"]) if (lines.sets.has(name)) lines.set(name, bed);
  }
  /** How many moves of each kind are among what is shown; null: not known yet. */
  counts() {
    if (!this.moves?.complete || !this.#shown) return null;
    const key = JSON.stringify(this.#shown);
    if (this.#counted.key !== key || this.#counted.of !== this.moves)
      this.#counted = { key, of: this.moves, counts: this.moves.counts(this.#shown.layers, this.#shown.end) };
    return this.#counted.counts;
  }

  #select(state) {
    const key = JSON.stringify([state.layers, state.printed, state.beads, state.by_time, state.hidden_features, state.objects, state.tools]);
    if (key === this.#key) return;
    this.#key = key;
    const { table } = this;
    const renderer = this.#renderer;
    const end = table.end(state);
    renderer.show(table.shown(state), end);
    // What is at the ends of the selection was hidden until now.
    const last = end < table.count ? table.layerOf(Math.max(0, end - 1)) : state.layers[1];
    for (const [low, high] of [[last - 2, last], [state.layers[0], state.layers[0] + 1]])
      if (high > 1) renderer.visible.expect(table.ofLayers(low, high));
  }

  /** The bead that is seen at a place of the picture, from 0 to 1 and from the upper left corner; -1: none. */
  at(x, y) {
    if (!this.ready || !this.#resting) return -1;
    const [width, height] = this.#renderer.size;
    const column = Math.min(width - 1, Math.floor(x * width));
    const line = Math.min(height - 1, Math.floor((1 - y) * height));
    return this.#renderer.ids(column, line, 1, 1)[0] - 1;
  }
}
