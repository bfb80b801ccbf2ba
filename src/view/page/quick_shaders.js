// The shaders of beads for moving pictures without a GPU: each bead is a flat ribbon that faces the eye, an arc several,
// shaded at the middle and the edges. A pixel costs a few operations there, not a ray, and those behind others are left out
// unshaded.
import { HEAD, NEAR, bead } from "./bead_shaders.js";
import { BEAD_BITS } from "./coarse_beads.js";
import { COLORED, STAGE } from "./light_shaders.js";

export const quickVertices = (kinds) => `${HEAD}
${bead(kinds)}
${STAGE}
${COLORED}
uniform vec2 size;          // pixels
uniform usampler2D ends;    // the last bead that one stands for; of an arc, the number of its ribbons
uniform float least;        // mm: half of how wide they are at least
out vec3 edge;              // colours
${alongArcs(kinds)} out vec3 middle;
out float across;           // -1 to 1
flat out float level;       // up to where the ribbon has the colour of its middle
flat out uint id;
// How far a bead reaches from its path.
float reach(Bead b, float half_flat, vec3 way) { return half_flat * length(way.xy) + b.side * abs(way.z) + b.radius; }
void main() {
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  uint n = chosen(uint(gl_VertexID >> 2));
#ifdef ARCS
  uint ribbon = n >> ${BEAD_BITS}u; // see CoarseBeads.ribbonsOf()
  n &= ${(1 << BEAD_BITS) - 1}u;
#endif
  id = n + 1u;
  uint shown_as = shownAs(n);
  if (shown_as == 0u) return;
  Bead b = beadAt(n);
  vec2 shares = vec2(0.0, 1.0);
  uint last = row(ends, n).x;
#ifdef ARCS
  uint ribbons = 1u;
  if (b.arc.z > 0.0) {
    ribbons = last;
    last = n;
    shares = (float(ribbon) + shares) / float(ribbons);
  }
#endif
  vec3 from = pointOf(b, shares.x), to = pointOf(b, shares.y);
  last = min(last, end - 1u);
  if (last > n) {
    uvec4 w = row(beads, last);
    to.xy = vec2(w.y & 65535u, w.y >> 16u) * grain.xy - eye.xy;
    to.z += (float(w.z >> 16u) - float(row(beads, n).z >> 16u)) * grain.z;
  }
  vec2 at = vec2(gl_VertexID & 1, gl_VertexID >> 1 & 1) * 2.0 - 1.0;
  vec3 path = to - from;
  bool at_end = true;         // of the bead, not between two ribbons of it
#ifdef ARCS
  // Two ribbons of an arc have the corners between them in common.
  if (b.arc.z > 0.0) {
    vec2 out_way = (at.x < 0.0 ? from : to).xy - b.start.xy - b.arc.xy;
    path = vec3(sign(b.sweep) * vec2(-out_way.y, out_way.x), b.climb / abs(b.sweep));
    at_end = ribbon == (at.x < 0.0 ? 0u : ribbons - 1u);
  }
#endif
  float past_from = dot(cut.xyz, from) - cut.w, past_to = dot(cut.xyz, to) - cut.w;
  if (cut.xyz != vec3(0.0) && max(past_from, past_to) > 0.0) {
    if (min(past_from, past_to) > 0.0) return;
    vec3 border = mix(from, to, past_from / (past_from - past_to));
    if (past_from > 0.0) from = border;
    else to = border;
    at_end = at_end || (at.x < 0.0 ? past_from : past_to) > 0.0;
  }
  vec3 p = at.x < 0.0 ? from : to;
  vec3 view = normalize(p);
  vec3 side_way = cross(path, view);
  bool end_on = dot(side_way, side_way) < 1e-8;
  side_way = end_on ? up : normalize(side_way);
  vec3 along_path = end_on ? right : normalize(path);
  vec3 along = cross(view, side_way);
  float half_flat = at.x < 0.0 ? b.flat0 : b.flat1;
  float wide = reach(b, half_flat, side_way);
  float drawn = max(wide, max(least, 1.5 * dot(p, forward) * slope.y / size.y)); // at least three quarters of a pixel
  // Ends are round: a straight one of the same area is nearer.
  if (at_end) p += along * at.x * 0.8 * reach(b, half_flat, along);
  p += side_way * at.y * drawn - view * reach(b, half_flat, view);
  float depth = dot(p, forward);
  gl_Position = vec4(dot(p, right) / slope.x, dot(p, up) / slope.y, 2.0 * ${NEAR} - depth, depth);
  // Of what lies side by side one sees the flats, of what lies on others the round sides, too.
  vec3 facing = cross(side_way, along_path);
  facing *= sign(-dot(facing, view) + 1e-9);
  facing = normalize(vec3(b.radius * facing.xy, (shown_as == 2u ? 6.0 : 0.5) * (0.3 * b.radius + half_flat) * facing.z));
  across = at.y;
  level = half_flat * length(side_way.xy) / wide;
  vec3 body = bodyOf(n); // which the surroundings darken by about 0.92
  middle = shadeOf(body, facing, view, 0.92 * openness(facing));
  vec3 beside = normalize(at.y * side_way + 0.5 * facing);
  edge = mix(middle, shadeOf(body, beside, view, 0.92 * openness(beside)), wide / drawn); // no grain of what is smaller than that
}`;
export const quickFragments = (kinds) => `${HEAD}
in vec3 edge;
${alongArcs(kinds)} in vec3 middle;
in float across;
flat in float level;
flat in uint id;
layout(location = 0) out vec4 color;
layout(location = 1) out uint bead;
void main() {
  float t = max(abs(across) - level, 0.0) / (1.001 - level);
  color = vec4(mix(middle, edge, t * t), 1.0);
  bead = id;
}`;
/** The middle's colour changes along an arc. */
function alongArcs(kinds) {
  return kinds.arcs ? "smooth" : "flat";
}
