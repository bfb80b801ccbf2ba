// The shaders of beads for moving pictures without a GPU: each bead is a flat ribbon that faces the eye, an arc several,
// shaded at the middle and the edges. A pixel costs a few operations there, not a ray, and those behind others are left out
// unshaded. A first pass makes the ribbons, one a pixel of a table: at their corners all would be found four times.
import { HEAD, bead } from "./bead_shaders.js";
import { BEAD_BITS } from "./coarse_beads.js";
import { COLORED, STAGE } from "./light_shaders.js";
import { ROW } from "./webgl.js";

export const ribbonFragments = (kinds) => `${HEAD}
${bead(kinds)}
${STAGE}
${COLORED}
uniform vec2 size;          // pixels
uniform usampler2D ends;    // the last bead that one stands for; of an arc, the number of its ribbons
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
// \`way\`: of the path there; \`end\`: 1 or -1 where the bead itself begins or ends, 0 between two ribbons of it.
void cross_section(Bead b, uint n, vec3 p, vec3 path, float half_flat, float end, bool side_by_side, out uvec4 place, out uvec4 side) {
  vec3 view = normalize(p);
  vec3 side_way = cross(path, view);
  bool end_on = dot(side_way, side_way) < 1e-8;
  side_way = end_on ? up : normalize(side_way);
  vec3 along_path = end_on ? right : normalize(path);
  vec3 along = cross(view, side_way);
  float wide = reach(b, half_flat, side_way);
  float drawn = max(wide, max(least, 1.5 * dot(p, forward) * slope.y / size.y)); // at least three quarters of a pixel
  // Ends are round: a straight one of the same area is nearer.
  p += along * end * 0.8 * reach(b, half_flat, along) - view * reach(b, half_flat, view);
  float depth = dot(p, forward);
  vec2 at = vec2(dot(p, right), dot(p, up)) / slope;
  vec2 beside = drawn * (vec2(dot(side_way, right), dot(side_way, up)) / slope - at * dot(side_way, forward) / max(depth, 1e-3));
  // Of what lies side by side one sees the flats, of what lies on others the round sides, too.
  vec3 facing = cross(side_way, along_path);
  facing *= sign(-dot(facing, view) + 1e-9);
  facing = normalize(vec3(b.radius * facing.xy, (side_by_side ? 6.0 : 0.5) * (0.3 * b.radius + half_flat) * facing.z));
  vec3 body = bodyOf(n); // which the surroundings darken by about 0.92
  vec3 middle = shadeOf(body, facing, view, 0.92 * openness(facing));
  vec3 low = normalize(0.5 * facing - side_way), high = normalize(0.5 * facing + side_way);
  float seen = wide / drawn;  // no grain of what is smaller than that
  place = uvec4(floatBitsToUint(vec3(at, depth)), tint(middle, half_flat * length(side_way.xy) / wide));
  side = uvec4(floatBitsToUint(beside), tint(mix(middle, shadeOf(body, low, view, 0.92 * openness(low)), seen), 0.0),
               tint(mix(middle, shadeOf(body, high, view, 0.92 * openness(high)), seen), 0.0));
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
    vec2 center = b.start.xy + b.arc.xy;
    float turn = sign(b.sweep), climb = b.climb / abs(b.sweep);
    from_path = vec3(turn * vec2(center.y - from.y, from.x - center.x), climb);
    to_path = vec3(turn * vec2(center.y - to.y, to.x - center.x), climb);
    begins = ribbon == 0u;
    stops = ribbon == ribbons - 1u;
  }
#endif
  float past_from = dot(cut.xyz, from) - cut.w, past_to = dot(cut.xyz, to) - cut.w;
  if (cut.xyz != vec3(0.0) && max(past_from, past_to) > 0.0) {
    if (min(past_from, past_to) > 0.0) return;
    vec3 border = mix(from, to, past_from / (past_from - past_to));
    if (past_from > 0.0) from = border;
    else to = border;
    begins = begins || past_from > 0.0;
    stops = stops || past_to > 0.0;
  }
  cross_section(b, n, from, from_path, b.flat0, begins ? -1.0 : 0.0, shown_as == 2u, from_place, from_side);
  cross_section(b, n, to, to_path, b.flat1, stops ? 1.0 : 0.0, shown_as == 2u, to_place, to_side);
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
