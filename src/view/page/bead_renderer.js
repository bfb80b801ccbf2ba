// Draws a table of beads with WebGL2, in two passes: which bead is nearest, then the light on it; or, where that takes too
// long, in one.
import { NEAR, SOUGHT, beadFragments, beadVertices, seekFragments, seekVertices } from "./bead_shaders.js";
import { GRID, backFragments, backVertices, gridFragments, lightFragments, screenVertices } from "./light_shaders.js";
import { CoarseBeads } from "./coarse_beads.js";
import { quickFragments, quickVertices, ribbonFragments } from "./quick_shaders.js";
import { VisibleBeads } from "./visible_beads.js";
import { LineRenderer } from "./line_renderer.js";
import { ROW, fillTable, makeFramebuffer, makeIndices, makeProgram, makeTable, makeTexture, release, setUniforms } from "./webgl.js";
import { dot, project, sub } from "./camera.js";

const SETS = 3; // of coarse beads that are kept: each takes half of what the table takes
const RIBBONS = 13; // the unit of their table
const MOVED = 0.1; // see hasMoved()
const DRAW = 16384; // beads or ribbons a call: their corners are counted in 16 bits

export class BeadRenderer {
  /** Throws an Error that says what is missing. */
  constructor(canvas, table) {
    const gl = canvas.getContext("webgl2", { antialias: false, alpha: false, depth: true, powerPreference: "high-performance" });
    if (!gl) throw new Error("no WebGL2");
    gl.getExtension("EXT_conservative_depth"); // beads behind others are left out before their ray is cast
    this.gl = gl;
    this.table = table;
    this.canvas = canvas;
    const most = gl.getParameter(gl.MAX_TEXTURE_SIZE);
    if (most < ROW || table.words.length / 4 > ROW * most) throw new Error("too many beads for its textures");
    this.visible = new VisibleBeads(table.count);
    this.coarse = new Map(); // sets of CoarseBeads
    const { kinds } = table;
    this.beads = makeProgram(gl, beadVertices(kinds), beadFragments(kinds));
    this.lit = makeProgram(gl, screenVertices, lightFragments);
    this.seek = makeProgram(gl, seekVertices(kinds), seekFragments);
    this.textures = {
      beads: makeTable(gl, table.words, 4),
      runs: makeTable(gl, table.runs, 4),
      shown: makeTable(gl, new Uint8Array(table.runs.length / 4).fill(1), 1),
      list: makeTable(gl, new Uint32Array(ROW), 1),
      colors: makeTable(gl, new Uint16Array(1), 1),
      light: makeTexture(gl, gl.LINEAR),
    };
    for (const name of ["coarse", "ends"]) this.textures[name] = makeTable(gl, new Uint32Array(1), 1);
    for (const name of ["palette", "ids", "normals", "depths", "picture"]) this.textures[name] = makeTexture(gl);
    this.units = Object.fromEntries(Object.keys(this.textures).map((name, n) => [name, n]));
    const corners = new Uint16Array(6 * DRAW);
    for (let n = 0; n < DRAW; ++n) corners.set([0, 1, 2, 1, 3, 2].map((k) => 4 * n + k), 6 * n);
    this.corners = makeIndices(gl, corners);
    const grid = [];
    for (let y = 0; y < GRID[1]; ++y)
      for (let x = 0; x < GRID[0]; ++x) grid.push(...[0, 1, GRID[0] + 1, GRID[0] + 1, 1, GRID[0] + 2].map((k) => y * (GRID[0] + 1) + x + k));
    this.grid = makeIndices(gl, Uint16Array.from(grid));
    this.target = makeFramebuffer(gl);
    this.quickTarget = makeFramebuffer(gl);
    this.ribbonTarget = makeFramebuffer(gl);
    this.ribbons = makeTexture(gl, gl.NEAREST, gl.TEXTURE_2D_ARRAY);
    this.ribbonRows = 0;
    this.found = makeFramebuffer(gl);
    const found = makeTexture(gl);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, ROW, SOUGHT / ROW, 0, gl.RGBA, gl.UNSIGNED_BYTE, null);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.found);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, found, 0);
    this.size = [0, 0];
    this.known = null; // camera and state whose beads and depths are in the textures
    this.unknown = null; // of the last picture if they are not
    this.end = table.count;
    this.look = null;
    this.seekTime = 0; // ms, of all beads in the last picture
    this.soughtFrom = null; // see hasMoved()
    this.backs = {}; // programs
    this.lines = new LineRenderer(gl);
    if (gl.getError()) throw new Error("not enough memory on its GPU");
  }

  /** It draws no more. */
  release() {
    release(this.gl);
  }

  /** By run, which are shown; and how many beads are printed. */
  show(shown, end) {
    fillTable(this.gl, this.textures.shown, shown, 1);
    this.end = end;
    this.soughtFrom = null;
  }

  /** Colours by bead, as places in a palette of [r, g, b], linear; null: one for all. */
  paint(places, palette) {
    const gl = this.gl;
    this.colored = places !== null;
    if (!places) return;
    fillTable(gl, this.textures.colors, places, 1);
    const values = new Float32Array(4 * 1024 * Math.ceil(palette.length / 1024));
    palette.forEach((color, n) => values.set(color, 4 * n));
    gl.bindTexture(gl.TEXTURE_2D, this.textures.palette);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA16F, 1024, Math.ceil(palette.length / 1024), 0, gl.RGBA, gl.FLOAT, values);
  }

  /** From the server: light, bed, exposure. */
  illuminate(look) {
    const gl = this.gl;
    this.look = look;
    const side = Math.sqrt(look.light.length / 2);
    gl.bindTexture(gl.TEXTURE_2D, this.textures.light);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RG16F, side, side, 0, gl.RG, gl.FLOAT, new Float32Array(look.light));
  }

  resize(width, height) {
    if (this.size[0] === width && this.size[1] === height) return;
    const gl = this.gl;
    this.size = [width, height];
    this.known = this.unknown = null;
    this.canvas.width = width;
    this.canvas.height = height;
    const numbers = [gl.R32UI, gl.RED_INTEGER, gl.UNSIGNED_INT];
    const kinds = {
      ids: numbers, normals: numbers,
      picture: [gl.RGBA8, gl.RGBA, gl.UNSIGNED_BYTE],
      depths: [gl.DEPTH_COMPONENT32F, gl.DEPTH_COMPONENT, gl.FLOAT],
    };
    for (const [name, [kind, format, type]] of Object.entries(kinds)) {
      gl.bindTexture(gl.TEXTURE_2D, this.textures[name]);
      gl.texImage2D(gl.TEXTURE_2D, 0, kind, width, height, 0, format, type, null);
    }
    for (const [target, ...names] of [[this.target, "ids", "normals"], [this.quickTarget, "picture", "ids"]]) {
      gl.bindFramebuffer(gl.FRAMEBUFFER, target);
      names.forEach((name, n) => gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + n, gl.TEXTURE_2D, this.textures[name], 0));
      gl.drawBuffers([gl.COLOR_ATTACHMENT0, gl.COLOR_ATTACHMENT1]);
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, this.textures.depths, 0);
    }
  }

  #view(camera, state) {
    const { low, grain } = this.table;
    const tangent = Math.tan((camera.fov * Math.PI) / 360);
    const cut = state.clip ?? [0, 0, 0, 0];
    const length = Math.hypot(...cut.slice(0, 3)) || 1;
    const normal = cut.slice(0, 3).map((v) => v / length);
    return {
      ...this.units,
      eye: sub(camera.eye, low), grain, right: camera.right, up: camera.up, forward: camera.forward,
      slope: [(tangent * this.size[0]) / this.size[1], tangent],
      cut: [...normal, cut[3] / length - dot(normal, camera.eye)],
      size: this.size, total: this.table.count, end: this.end,
    };
  }

  #bind() {
    const gl = this.gl;
    Object.values(this.textures).forEach((texture, n) => {
      gl.activeTexture(gl.TEXTURE0 + n);
      gl.bindTexture(gl.TEXTURE_2D, texture);
    });
    gl.activeTexture(gl.TEXTURE0 + 31);
  }

  /** Starts a picture, or goes on with it: `parts` more of the beads that were seen, and then of all; 0: of the former, all.
   * Returns whether all are in it. `seek`: with all beads that come into sight. */
  collect(camera, state, parts, anew, seek = false) {
    const gl = this.gl;
    this.#use(this.beads, this.target, this.#view(camera, state));
    this.unknown = null;
    this.known = [camera, state];
    if (anew) {
      this.visible.restart();
      gl.clearBufferuiv(gl.COLOR, 0, [0, 0, 0, 0]);
      gl.clearBufferfv(gl.DEPTH, 0, [0]);
      this.#fillList(this.visible.seenBeads);
    }
    if (!parts) this.#drawBeads(this.beads, true, 0, this.visible.count);
    if (seek) {
      const found = this.#seekAll();
      this.#use(this.beads, this.target, this.#view(camera, state));
      this.#fillList(found);
      this.#drawBeads(this.beads, true, 0, found.length);
    }
    for (let n = 0; n < parts && !this.visible.complete; ++n) this.#drawBeads(this.beads, ...this.visible.part());
    return this.visible.complete;
  }

  /** Shows what was collected. */
  light(camera, state) {
    const gl = this.gl;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.disable(gl.DEPTH_TEST);
    const values = this.#stage(camera, state);
    this.#drawBack(values, false);
    gl.useProgram(this.lit.program);
    setUniforms(gl, this.lit, values);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(...this.#frame(camera));
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.disable(gl.SCISSOR_TEST);
    gl.disable(gl.BLEND);
    this.lines.draw({ ...values, eye: camera.eye }, this.textures.depths);
  }

  /** A picture of the beads that were seen lately, by the quick shaders. `known`: with which bead and which depth is where.
   * Without these it is drawn on the canvas itself, which has no place for them, and needs no way there. `seek`: with all
   * beads that come into sight. */
  drawQuick(camera, state, known = true, seek = false) {
    const gl = this.gl;
    this.#makeQuick();
    const coarse = this.coarseFor(camera, state);
    known ||= seek || this.lines.any;
    this.unknown = known ? null : [camera, state];
    if (known) this.known = [camera, state];
    // The canvas may have depths of 24 bits.
    const near = known ? NEAR : Math.max(NEAR, 0.9 * Math.min(...this.#corners().map((corner) => dot(sub(corner, camera.eye), camera.forward))));
    const values = { ...this.#stage(camera, state), ribbons: RIBBONS, least: 0.6 * coarse.stride * this.table.layerHeight, near };
    const draw = (list, anew) => {
      const ribbons = coarse.ribbonsOf(list);
      this.#makeRibbons(ribbons, values);
      this.#use(this.quick, known ? this.quickTarget : null, values);
      if (anew) {
        gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
        if (known) gl.clearBufferuiv(gl.COLOR, 1, [0, 0, 0, 0]);
        gl.clearBufferfv(gl.DEPTH, 0, [0]);
      }
      this.#drawBeads(this.quick, true, 0, ribbons.length);
    };
    draw(this.visible.seenBeads, true);
    if (seek) draw(this.#seekAll(), false);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.depthFunc(gl.GEQUAL);
    if (known) gl.disable(gl.DEPTH_TEST);
    this.#drawBack(values, known);
    if (known) this.lines.draw({ ...values, eye: camera.eye }, this.textures.depths);
  }

  #makeQuick() {
    const { kinds } = this.table;
    this.quick ??= makeProgram(this.gl, quickVertices(kinds), quickFragments(kinds));
    this.maker ??= makeProgram(this.gl, screenVertices, ribbonFragments(kinds));
  }
  /** What drawQuick() needs is made, and nothing is drawn. Without a GPU half a second goes into the first ribbons. */
  prepareQuick(camera, state) {
    if (this.quick) return;
    const gl = this.gl;
    this.#makeQuick();
    const values = { ...this.#stage(camera, state), ribbons: RIBBONS, end: 0, least: 0, near: NEAR }; // no bead is printed
    this.#makeRibbons(Uint32Array.of(0), values);
    this.#use(this.quick, this.quickTarget, values);
    this.#drawBeads(this.quick, true, 0, 1);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.disable(gl.DEPTH_TEST);
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(0, 0, 0, 0);
    this.#drawBack(values, true);
    gl.disable(gl.SCISSOR_TEST);
  }

  /** Makes the table of ribbons. */
  #makeRibbons(list, values) {
    const gl = this.gl;
    const rows = Math.ceil(list.length / ROW);
    if (!rows) return;
    this.#use(this.maker, this.ribbonTarget, values, [ROW, rows]);
    gl.disable(gl.DEPTH_TEST);
    this.#fillList(list);
    gl.activeTexture(gl.TEXTURE0 + RIBBONS);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.ribbons);
    if (rows > this.ribbonRows) {
      this.ribbonRows = rows;
      gl.texImage3D(gl.TEXTURE_2D_ARRAY, 0, gl.RGBA32UI, ROW, rows, 4, 0, gl.RGBA_INTEGER, gl.UNSIGNED_INT, null);
      for (let n = 0; n < 4; ++n) gl.framebufferTextureLayer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + n, this.ribbons, 0, n);
      gl.drawBuffers([0, 1, 2, 3].map((n) => gl.COLOR_ATTACHMENT0 + n));
    }
    setUniforms(gl, this.maker, { from_list: true, first: 0, count: list.length });
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  /** How coarse beads may be, by the size of a pixel: by powers of two, and it changes seldom. Others are sought in the last
   * picture, so before a change of size, which that does not survive. */
  coarseFor(camera, { layers }, height = this.size[1]) {
    const { low, grain, layerHeight } = this.table;
    const depth = dot(sub(low.map((v, axis) => v + 32768 * grain[axis]), camera.eye), camera.forward);
    const pixel = (2 * Math.max(depth, 1) * Math.tan((camera.fov * Math.PI) / 360)) / height;
    const few = layers[1] ? (layers[1] - (layers[0] || 1)) / 16 : Infinity;
    const old = this.visible.coarse;
    if (old && old.few === few && pixel > 0.8 * old.tolerance && pixel < 2.5 * old.tolerance) return old;
    const tolerance = 2 ** Math.floor(Math.log2(pixel));
    const stride = 2 ** Math.floor(Math.log2(Math.max(1, Math.min(few, (1.5 * tolerance) / layerHeight))));
    const key = `${stride} ${tolerance}`;
    if (!this.coarse.has(key)) {
      const [oldest] = this.coarse.keys();
      if (this.coarse.size >= SETS) this.coarse.delete(oldest);
      this.coarse.set(key, new CoarseBeads(this.table, stride, tolerance));
    }
    const coarse = Object.assign(this.coarse.get(key), { few });
    if (coarse === old) return old;
    fillTable(this.gl, this.textures.coarse, coarse.beads, 1);
    fillTable(this.gl, this.textures.ends, coarse.ends, 1);
    this.visible.standFor(coarse);
    this.#bind();
    if (this.known) this.#seekAll();
    else this.soughtFrom = null;
    return coarse;
  }

  /** From here on moving pictures have the beads themselves, no coarse ones. */
  drawAllBeads() {
    if (!this.visible.coarse) return;
    this.visible.standFor(null);
    this.soughtFrom = null; // the others are to be sought
  }

  /** Draws beads into a target from here on. */
  #use(program, target, values, size = this.size) {
    const gl = this.gl;
    this.#bind();
    gl.useProgram(program.program);
    setUniforms(gl, program, values);
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    gl.viewport(0, 0, ...size);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.GREATER);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.corners);
  }

  #fillList(list) {
    this.gl.activeTexture(this.gl.TEXTURE0 + this.units.list);
    fillTable(this.gl, this.textures.list, list, 1);
  }

  #drawBeads(program, from_list, first, count) {
    const gl = this.gl;
    for (let n = 0; n < count; n += DRAW) {
      setUniforms(gl, program, { from_list, first: first + n });
      gl.drawElements(gl.TRIANGLES, 6 * Math.min(DRAW, count - n), gl.UNSIGNED_SHORT, 0);
    }
  }

  /** What programs get that make light. */
  #stage(camera, state) {
    const { look } = this;
    const bed = camera.eye[2] > look.bed?.z ? look.bed : null;
    const angle = look.follows ? Math.atan2(camera.right[1], camera.right[0]) - Math.atan2(look.right[1], look.right[0]) : 0;
    return {
      ...this.#view(camera, state), has_bed: Number(bed !== null), bed_albedo: bed?.albedo ?? [0, 0, 0], horizon: look.horizon, zenith: look.zenith,
      turned: [Math.cos(angle), Math.sin(angle)], brightest: look.brightest, scale: 2 ** look.exposure,
      bed_z: (bed?.z ?? 0) - camera.eye[2], corner: this.table.low.slice(0, 2),
      fade: bed ? [bed.center[0] - camera.eye[0], bed.center[1] - camera.eye[1], ...bed.fade] : [0, 0, 0, 1],
      colored: Number(this.colored ?? false), as_normals: Number(state.integrator === "normal"), albedo: look.albedo, reach: look.reach,
    };
  }

  #drawBack(values, over) {
    const gl = this.gl;
    const grid = values.has_bed && this.look.bed.grid && !values.as_normals;
    const back = (this.backs[`${grid} ${over}`] ??= makeProgram(gl, backVertices, (grid ? gridFragments : backFragments)(over)));
    gl.useProgram(back.program);
    setUniforms(gl, back, values);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.grid);
    gl.drawElements(gl.TRIANGLES, 6 * GRID[0] * GRID[1], gl.UNSIGNED_SHORT, 0);
  }

  /** Of a box about the print. */
  #corners() {
    const { low, grain } = this.table;
    return [0, 1, 2, 3, 4, 5, 6, 7].map((n) => low.map((v, axis) => (n & (1 << axis) ? v + 65535 * grain[axis] + 3 : v - 3)));
  }

  /** Pixels that the print's box may cover: x, y, width, height from below. */
  #frame(camera) {
    const [width, height] = this.size;
    const places = this.#corners().map((corner) => project(camera, width / height, corner));
    if (places.includes(null)) return [0, 0, width, height];
    const span = (values, side) => {
      const first = Math.max(0, Math.floor(Math.min(...values) * side - 8));
      return [first, Math.max(0, Math.min(side, Math.ceil(Math.max(...values) * side + 8)) - first)];
    };
    const [x, across] = span(places.map(([right]) => right), width);
    const [y, up] = span(places.map(([, down]) => 1 - down), height);
    return [x, y, across, up];
  }

  /** Whether a view differs so much from the last one of which all was sought that beads may be missed: the print is seen
   * from elsewhere (radians), from nearer or farther (share), or is at another place (share of the height). */
  hasMoved(camera) {
    const [width, height] = this.size;
    const middle = this.table.low.map((v, axis) => v + 32768 * this.table.grain[axis]);
    const way = sub(camera.eye, middle);
    const far = Math.hypot(...way) || 1;
    // Behind the camera it has no place in the picture: its direction counts.
    const [right, down] = project(camera, width / height, middle) ?? [dot(way, camera.right) / far, dot(way, camera.up) / far];
    const now = [...way.map((v) => v / far), Math.log(far), (right * width) / height, down];
    const old = this.soughtFrom;
    if (old && now.every((v, n) => Math.abs(v - old[n]) < MOVED)) return false;
    this.soughtFrom = now;
    return true;
  }

  /** Looks in the last picture with depths for `rows` more of the beads that may have come into sight; the next one has them. */
  lookFor(rows) {
    if (this.known) this.#seek(...this.visible.sought(rows * ROW));
  }

  /** The beads that come into sight in the picture at work, and are not in it. Of very many only a part is sought. */
  #seekAll() {
    const { visible } = this;
    this.finish();
    const began = performance.now();
    const before = visible.count;
    const all = visible.coarse?.beads.length ?? visible.all;
    for (let calls = Math.min(2, Math.ceil(all / SOUGHT)); calls > 0; --calls) this.#seek(...visible.sought(SOUGHT));
    this.seekTime = performance.now() - began;
    return visible.list.subarray(before, visible.count);
  }

  #seek(first, count) {
    const gl = this.gl;
    const { coarse } = this.visible;
    const rows = Math.ceil(count / ROW);
    this.shift = ((this.shift ?? 0) + 0.618) % 1;
    this.#bind();
    gl.useProgram(this.seek.program);
    setUniforms(gl, this.seek, { ...this.#view(...this.known), list: this.units.coarse, from_list: coarse !== null, first, shift: this.shift });
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.found);
    gl.viewport(0, 0, ROW, SOUGHT / ROW);
    gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
    gl.drawArrays(gl.POINTS, 0, count);
    const found = new Uint32Array(rows * ROW);
    gl.readPixels(0, 0, ROW, rows, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(found.buffer));
    const beads = [];
    for (let n = 0; n < count; ++n) if (found[n]) beads.push(coarse ? coarse.beads[first + n] : first + n);
    this.visible.expect(beads);
  }

  /** Waits until the picture is there. */
  finish() {
    if (!this.unknown) return this.ids(0, 0, 1, 1);
    this.gl.bindFramebuffer(this.gl.FRAMEBUFFER, null);
    this.gl.readPixels(0, 0, 1, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, new Uint8Array(4));
  }

  /** Remembers which beads the picture shows. */
  note() {
    this.visible.seen(this.ids(0, 0, ...this.size));
  }

  /** Which bead + 1 is at each pixel of a rectangle, from below; 0: none. */
  ids(x, y, width, height) {
    const gl = this.gl;
    if (this.unknown) this.drawQuick(...this.unknown);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    const red = gl.getParameter(gl.IMPLEMENTATION_COLOR_READ_FORMAT) === gl.RED_INTEGER;
    const words = new Uint32Array((red ? 1 : 4) * width * height);
    gl.readPixels(x, y, width, height, red ? gl.RED_INTEGER : gl.RGBA_INTEGER, gl.UNSIGNED_INT, words);
    return red ? words : words.filter((_, n) => n % 4 === 0);
  }
}
