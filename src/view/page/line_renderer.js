// Thin lines and round marks in the picture: travels, seams and the like, and the bed. Beads in front of them hide them.
import { HEAD, NEAR } from "./bead_shaders.js";
import { LINES } from "./move_table.js";
import { makeFramebuffer, makeProgram, makeTable, makeTexture, setUniforms } from "./webgl.js";

const vertices = `${HEAD}
uniform usampler2D records; // two texels each, see move_stream.h; the last word has the layer instead of the line
uniform vec3 eye, right, up, forward;
uniform vec2 slope;
uniform uint kinds;         // a bit each
uniform uvec2 layers;       // from, to
uniform uint end;           // beads that are printed
uniform float point;        // pixels; 0: lines
out vec3 way;
flat out uint kind;
void main() {
  uint n = uint(gl_VertexID) >> (point > 0.0 ? 0u : 1u);
  uvec4 a = row(records, 2u * n), b = row(records, 2u * n + 1u);
  kind = b.w >> 28u & 7u;
  uint layer = b.w & 0xfffffffu;
  way = vec3(0.0);
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  gl_PointSize = point;
  if ((kinds >> kind & 1u) == 0u || layer < layers.x || layer > layers.y || b.z >= end) return;
  bool second = point == 0.0 && (gl_VertexID & 1) == 1;
  way = uintBitsToFloat(second ? uvec3(a.w, b.xy) : a.xyz) - eye;
  float depth = dot(way, forward);
  gl_Position = vec4(dot(way, right) / slope.x, dot(way, up) / slope.y, depth - 0.2, depth); // nearer than 0.1 mm: cut off
}`;
const fragments = `${HEAD}
uniform vec3 forward;
uniform vec4 cut;
uniform sampler2D depths;   // of the beads
uniform float lift;         // mm towards the eye
uniform float point;
uniform vec3 tints[8];      // by kind
in vec3 way;
flat in uint kind;
out vec4 color;
void main() {
  if (cut.xyz != vec3(0.0) && dot(cut.xyz, way) > cut.w) discard;
  if (dot(way, forward) - lift > ${NEAR} / max(texelFetch(depths, ivec2(gl_FragCoord.xy), 0).x, 1e-9)) discard;
  float r = point > 0.0 ? length(2.0 * gl_PointCoord - 1.0) : 0.0;
  if (r > 1.0) discard;
  color = vec4(r > 0.72 ? vec3(0.1) : tints[kind], 1.0);
}`;

export class LineRenderer {
  /** By name: { texture, count, kinds, layers, end, point, tints }; `kinds` of LINES are lines, others are marks. */
  sets = new Map();

  constructor(gl) {
    this.gl = gl;
    this.program = makeProgram(gl, vertices, fragments);
    this.target = makeFramebuffer(gl);
    this.image = makeTexture(gl);
  }

  /** Shows these records, and forgets what had that name; null: nothing. What is not given stays as it was. */
  set(name, values) {
    const old = this.sets.get(name);
    if (old?.texture && (values === null || values.table)) this.gl.deleteTexture(old.texture);
    if (values === null) return this.sets.delete(name);
    const { table, ...rest } = values;
    this.sets.set(name, { ...old, ...rest, ...(table && { texture: makeTable(this.gl, table, 4), count: table.length / 8 }) });
  }

  /** Whether a picture has any. */
  get any() {
    return [...this.sets.values()].some(({ kinds, count }) => kinds && count);
  }

  /** On the picture that the framebuffer has. */
  draw(view, depths) {
    const gl = this.gl;
    this.last = [view, depths];
    gl.useProgram(this.program.program);
    gl.activeTexture(gl.TEXTURE0 + 15);
    gl.bindTexture(gl.TEXTURE_2D, depths);
    gl.activeTexture(gl.TEXTURE0 + 14);
    for (const { texture, count, ...values } of this.sets.values()) {
      if (!values.kinds || !count) continue;
      gl.bindTexture(gl.TEXTURE_2D, texture);
      setUniforms(gl, this.program, { ...view, ...values, records: 14, depths: 15, "tints[0]": values.tints.flat() });
      // A mark stands out of its bead by half a width.
      setUniforms(gl, this.program, { kinds: values.kinds & LINES, point: 0, lift: 0.1 });
      if (values.kinds & LINES) gl.drawArrays(gl.LINES, 0, 2 * count);
      setUniforms(gl, this.program, { kinds: values.kinds & ~LINES, point: values.point, lift: 0.6 });
      if (values.kinds & ~LINES) gl.drawArrays(gl.POINTS, 0, count);
    }
  }

  /** The lines of the last picture alone, as a canvas that is upside down; null if there are none. */
  alone() {
    const gl = this.gl;
    if (!this.last || !this.any) return null;
    const [width, height] = this.last[0].size;
    gl.bindTexture(gl.TEXTURE_2D, this.image);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, width, height, 0, gl.RGBA, gl.UNSIGNED_BYTE, null);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.image, 0);
    gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
    this.draw(...this.last);
    const image = new ImageData(width, height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, image.data);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    const canvas = new OffscreenCanvas(width, height);
    canvas.getContext("2d").putImageData(image, 0, 0);
    return canvas;
  }
}
