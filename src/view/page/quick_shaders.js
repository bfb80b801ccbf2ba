// The shaders of beads for moving pictures without a GPU: each bead is a flat ribbon that faces the eye, an arc several,
// shaded at the middle and the edges. A pixel costs a few operations there, not a ray, and those behind others are left out
// unshaded. A first pass makes the ribbons, one a pixel of a table: at their corners all would be found four times.
import { HEAD, NEAR, bead } from "./bead_shaders.js";
import { BEAD_BITS } from "./coarse_beads.js";
import { COLORED, STAGE } from "./light_shaders.js";
import { ROW } from "./webgl.js";

export const ribbonFragments = (kinds) => `${HEAD}
${bead(kinds)}
${STAGE}
${COLORED}
uniform vec2 size;          // pixels
uniform usampler2D ends;    // see CoarseBeads
uniform float least;        // mm: half of how wide they are at least
uniform uint count;
// Of each end: where it is on the picture times its depth, that depth, the colour of the middle and up to where the ribbon has
// it; from there to its upper side, the colours of both sides.
layout(location = 0) out uvec4 from_place;
layout(location = 1) out uvec4 from_side;
layout(location = 2) out uvec4 to_place;
layout(location = 3) out uvec4 to_side;
// How far a bead reaches from its path.
float reach(Bead b, float half_flat, vec3 way) { return half_flat * length(way.xy) + b.side * abs(way.z) + b.radius; }
uint tint(vec3 color, float level) {
  uvec4 bytes = uvec4(clamp(vec4(color, level), 0.0, 1.0) * 255.0 + 0.5);
  return bytes.x | bytes.y << 8 | bytes.z << 16 | bytes.w << 24;
}
// Of ways that meet, as the eye sees them: the one between them, twice the cosine of their half angle long; 0 if they turn by
// more than about 75 degrees, where round ends are nearer.
vec3 between(vec3 a, vec3 b, vec3 view) {
  a -= dot(a, view) * view;
  b -= dot(b, view) * view;
  if (min(dot(a, a), dot(b, b)) < 1e-8) return vec3(0.0);
  a = normalize(a);
  b = normalize(b);
  return dot(a, b) > 0.25 ? a + b : vec3(0.0);
}
// \`path\`: its way there; \`beyond\`: the way of what goes on there, or 0; \`end\`: 1 or -1 where it would end, 0 between two ribbons of it.
void cross_section(Bead b, uint n, vec3 p, vec3 path, vec3 beyond, float half_flat, float end, bool side_by_side, out uvec4 place, out uvec4 side) {
  vec3 view = normalize(p);
  vec3 side_way = cross(path, view);
  bool end_on = dot(side_way, side_way) < 1e-8;
  side_way = end_on ? up : normalize(side_way);
  vec3 along_path = end_on ? right : normalize(path);
  vec3 along = cross(view, side_way);
  float wide = reach(b, half_flat, side_way);
  float drawn = max(wide, max(least, 1.5 * dot(p, forward) * slope.y / size.y)); // at least three quarters of a pixel
  float seen = wide / drawn;  // no grain of what is smaller than that
  vec3 joint = between(path, beyond, view), border = side_way * drawn;
  if (joint != vec3(0.0)) {
    // A longer tip would stand out of the round end.
    border = normalize(cross(joint, view)) * drawn * min(2.0 / length(joint), 1.1);
    end = 0.0;
  }
  // Ends are round: a straight one of the same area is nearer.
  p += along * end * 0.8 * reach(b, half_flat, along) - view * min(reach(b, half_flat, view), 0.9 * length(p));
  float depth = dot(p, forward);
  vec2 at = vec2(dot(p, right), dot(p, up)) / slope;
  // Far beside the picture, where a bead passes the eye, it would be as wide as that is away.
  vec2 beside = vec2(dot(border, right), dot(border, up)) / slope - clamp(at / max(depth, 1e-3), -3.0, 3.0) * dot(border, forward);
  // Of what lies side by side one sees the flats, of what lies on others the round sides, too.
  vec3 facing = cross(side_way, along_path);
  facing *= sign(-dot(facing, view) + 1e-9);
  facing = normalize(vec3(b.radius * facing.xy, (side_by_side ? 6.0 : 0.5) * (0.3 * b.radius + half_flat) * facing.z));
  vec3 body = bodyOf(n); // which the surroundings darken by about 0.92
  vec3 middle = shadeOf(body, facing, view, 0.92 * openness(facing));
  vec3 low = normalize(0.5 * facing - side_way), high = normalize(0.5 * facing + side_way);
  place = uvec4(floatBitsToUint(vec3(at, depth)), tint(middle, half_flat * length(side_way.xy) / wide));
  side = uvec4(floatBitsToUint(beside), tint(mix(middle, shadeOf(body, low, view, 0.92 * openness(low)), seen), 0.0),
               tint(mix(middle, shadeOf(body, high, view, 0.92 * openness(high)), seen), 0.0));
}
vec3 stepsOf(uvec4 w) { return grain * (vec3(w.y & 65535u, w.y >> 16u, w.z >> 16u) - vec3(w.x & 65535u, w.x >> 16u, w.z & 65535u)); }
vec3 stepsTo(uvec4 a, uvec4 b) { return stepsOf(uvec4(a.x, b.y, a.z & 65535u | b.z & 0xffff0000u, 0u)); } // from where a begins to where b ends
bool goesOn(uvec4 a, uvec4 b) { return a.y == b.x && a.z >> 16u == (b.z & 65535u); }
#ifdef ARCS
bool tangent(uint n, float share, out vec3 way) {
  Bead b = beadAt(n);
  if (b.arc.z == 0.0) return false;
  vec2 out_way = pointOf(b, share).xy - b.start.xy - b.arc.xy;
  way = vec3(sign(b.sweep) * vec2(-out_way.y, out_way.x), b.climb / abs(b.sweep));
  return true;
}
#endif
// The ways of what comes before the bead n and of what goes on after the bead \`last\`, or 0.
vec3 wayBefore(uint n) {
  if (n == 0u || shownAs(n - 1u) == 0u) return vec3(0.0);
  uvec4 w = row(beads, n - 1u);
  if (!goesOn(w, row(beads, n))) return vec3(0.0);
#ifdef ARCS
  vec3 way;
  if (tangent(n - 1u, 1.0, way)) return way;
#endif
  return stepsTo((w.w & 4096u) != 0u ? w : row(beads, min(row(ends, n - 1u).x, n - 1u)), w);
}
vec3 wayAfter(uint last) {
  if (last + 1u >= total || shownAs(last + 1u) == 0u) return vec3(0.0);
  uvec4 w = row(beads, last + 1u);
  if (!goesOn(row(beads, last), w)) return vec3(0.0);
#ifdef ARCS
  vec3 way;
  if (tangent(last + 1u, 0.0, way)) return way;
#endif
  return stepsTo(w, (w.w & 4096u) != 0u ? w : row(beads, min(row(ends, last + 1u).x, end - 1u)));
}
void main() {
  from_place = from_side = to_place = to_side = uvec4(0u);
  uint entry = uint(gl_FragCoord.y) * ${ROW}u + uint(gl_FragCoord.x);
  if (entry >= count) return;
  uint n = chosen(entry);
#ifdef ARCS
  uint ribbon = n >> ${BEAD_BITS}u; // see CoarseBeads.ribbonsOf()
  n &= ${(1 << BEAD_BITS) - 1}u;
#endif
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
  vec3 from_path = to - from, to_path = from_path;
  bool begins = true, stops = true; // the bead itself, not a ribbon of it
#ifdef ARCS
  // Two ribbons of an arc have the corners between them in common.
  if (b.arc.z > 0.0) {
    tangent(n, shares.x, from_path);
    tangent(n, shares.y, to_path);
    begins = ribbon == 0u;
    stops = ribbon == ribbons - 1u;
  }
#endif
  vec3 before = begins ? wayBefore(n) : vec3(0.0), after = stops ? wayAfter(last) : vec3(0.0);
  for (int k = 0; k < 2; ++k) { // what is behind the eye is cut away, too
    vec4 plane = k == 0 ? cut : vec4(-forward, ${-NEAR});
    float past_from = dot(plane.xyz, from) - plane.w, past_to = dot(plane.xyz, to) - plane.w;
    if (plane.xyz == vec3(0.0) || max(past_from, past_to) <= 0.0) continue;
    if (min(past_from, past_to) > 0.0) return;
    vec3 border = mix(from, to, past_from / (past_from - past_to));
    if (past_from > 0.0) from = border;
    else to = border;
    if (past_from > 0.0) before = vec3(0.0);
    else after = vec3(0.0);
    begins = past_from > 0.0 ? k == 0 : begins;
    stops = past_to > 0.0 ? k == 0 : stops;
  }
  cross_section(b, n, from, from_path, before, b.flat0, begins ? -1.0 : 0.0, shown_as == 2u, from_place, from_side);
  cross_section(b, n, to, to_path, after, b.flat1, stops ? 1.0 : 0.0, shown_as == 2u, to_place, to_side);
}`;
/** The colours of a straight ribbon are those of its beginning, those of an arc change along it. */
const alongArcs = (kinds) => (kinds.arcs ? "smooth" : "flat");
export const quickVertices = (kinds) => `${HEAD}
${bead(kinds)}
uniform highp usampler2DArray ribbons;
uniform float near;         // mm, of depth 1
${alongArcs(kinds)} out vec3 middle;
${alongArcs(kinds)} out vec3 low;
${alongArcs(kinds)} out vec3 high;
out float across;           // -1 to 1
flat out float level;       // up to where the ribbon has the colour of its middle
flat out uint id;
vec3 color(uint tint) { return vec3(uvec3(tint, tint >> 8, tint >> 16) & 255u) / 255.0; }
void main() {
  uint n = first + uint(gl_VertexID >> 2);
  ivec3 texel = ivec3(n % ${ROW}u, n / ${ROW}u, 2 * (gl_VertexID & 1));
  uvec4 place = texelFetch(ribbons, texel, 0), side = texelFetch(ribbons, texel + ivec3(0, 0, 1), 0);
  vec3 p = uintBitsToFloat(place.xyz);
  across = (gl_VertexID & 2) == 0 ? -1.0 : 1.0;
  gl_Position = p.z == 0.0 ? vec4(2.0, 2.0, 2.0, 1.0) : vec4(p.xy + across * uintBitsToFloat(side.xy), 2.0 * near - p.z, p.z);
  middle = color(place.w);
  low = color(side.z);
  high = color(side.w);
  level = float(place.w >> 24) / 255.0;
  id = (chosen(uint(gl_VertexID >> 2))${kinds.arcs ? ` & ${(1 << BEAD_BITS) - 1}u` : ""}) + 1u;
}`;
export const quickFragments = (kinds) => `${HEAD}
${alongArcs(kinds)} in vec3 middle;
${alongArcs(kinds)} in vec3 low;
${alongArcs(kinds)} in vec3 high;
in float across;
flat in float level;
flat in uint id;
layout(location = 0) out vec4 color;
layout(location = 1) out uint bead;
void main() {
  float t = max(abs(across) - level, 0.0) / (1.001 - level);
  color = vec4(mix(middle, across < 0.0 ? low : high, t * t), 1.0);
  bead = id;
}`;
