// The shaders of beads: capsules with flats, hit by one ray a pixel.
//
// The shape of a bead is that of the level set (src/voxelize/beads/bead_field.h). Lengths are mm; points are relative
// to the eye, so that floats are fine near the surface. Depth is along the viewing direction.
import { ROW, ROW_BITS } from "./webgl.js";

export const NEAR = 0.05; // mm, of depth 1
/** Beads that are looked for at a time, at most. */
export const SOUGHT = 32 * ROW;

export const HEAD = `#version 300 es
#extension GL_EXT_conservative_depth : enable
precision highp float;
precision highp int;
precision highp usampler2D;
precision highp sampler2D;
// A direction as a place of the unit square, by an octahedron; and a unit vector in 32 bits.
vec2 folded(vec2 p) { return (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0); }
vec2 octahedral(vec3 v) {
  v /= abs(v.x) + abs(v.y) + abs(v.z);
  return 0.5 * (v.z < 0.0 ? folded(v.xy) : v.xy) + 0.5;
}
uint packed(vec3 v) { return packUnorm2x16(octahedral(v)); }
vec3 unpacked(uint word) {
  vec2 p = 2.0 * unpackUnorm2x16(word) - 1.0;
  vec3 v = vec3(p, 1.0 - abs(p.x) - abs(p.y));
  if (v.z < 0.0) v.xy = folded(v.xy);
  return normalize(v);
}
uvec4 row(usampler2D table, uint n) { return texelFetch(table, ivec2(n & ${(1 << ROW_BITS) - 1}u, n >> ${ROW_BITS}u), 0); }`;

// What the programs share: a bead of the table, and where a ray meets it.
const BEAD = `
uniform usampler2D beads;   // a texel a bead, see bead_stream.h; behind all of them what more belongs to them
uniform uint total;         // beads
uniform usampler2D runs;    // height, straight side (floats); layer; feature, tool, object
uniform vec3 eye;           // from the corner that the table counts from
uniform vec3 grain;         // mm a step of the table
uniform vec3 right, up, forward;
uniform vec2 slope;         // tangents of half the angles of the picture
uniform vec4 cut;           // a plane from the eye: what lies beyond it along cut.xyz is cut away; zero: none

struct Bead {
  vec3 start;               // of the center line, from the eye
  vec2 along;               // unit, in the plan
  float len, climb;         // of the path in the plan; of z over it
  float flat0, flat1;       // half the flat at the ends
  float radius, side;       // of the corners; half the height of the straight sides
#ifdef ARCS
  vec3 arc;                 // center from the start, and radius; radius 0: straight
  vec2 from, to;            // unit, from the center to the ends
  float sweep;
#endif
};

Bead beadAt(uint n) {
  uvec4 w = row(beads, n);
  uvec4 run = row(runs, w.w >> 13u);
  float height = uintBitsToFloat(run.x), side = uintBitsToFloat(run.y);
  float width = float(w.w & 4095u) * 0.004;
  Bead b;
  b.start = vec3(w.x & 65535u, w.x >> 16u, w.z & 65535u) * grain - eye;
  b.start.z -= 0.5 * height;
  vec3 way = vec3(w.y & 65535u, w.y >> 16u, w.z >> 16u) * grain - eye;
  way.z -= 0.5 * height;
  way -= b.start;
  b.len = length(way.xy);
  b.along = b.len > 0.0 ? way.xy / b.len : vec2(1.0, 0.0);
  b.climb = way.z;
  b.radius = 0.5 * min(width, height);
  b.side = 0.0;
  float half_flat = 0.5 * max(width - height, 0.0);
#ifdef CORNERS
  if (side > 0.0 && width >= height) {
    b.side = side;
    b.radius -= side;
    float corners = 4.0 - 3.14159265;
    half_flat = 0.5 * width - (0.125 * corners * height - 0.5 * corners * b.radius * b.radius / height + b.radius);
  }
#endif
#ifdef SLOPES
  if (half_flat > 0.0 && abs(b.climb) > b.len) {
    b.radius = sqrt(height * (width - height * 0.2146018) / 3.14159265);
    half_flat = b.side = 0.0;
  }
#endif
  b.flat0 = b.flat1 = half_flat;
#ifdef EXTRAS
  float widening = 0.0;
  uvec4 extra = uvec4(0u);
  if ((w.w & 4096u) != 0u) {
    extra = row(beads, total + n);
    widening = uintBitsToFloat(extra.w);
    b.flat0 = max(half_flat - 0.25 * widening, 0.0);
    b.flat1 = max(half_flat + 0.25 * widening, 0.0);
  }
#endif
#ifdef ARCS
  b.arc = vec3(0.0);
  b.sweep = uintBitsToFloat(extra.z);
  if (b.sweep != 0.0) {
    b.arc.xy = uintBitsToFloat(extra.xy) - eye.xy - b.start.xy;
    vec2 a = -b.arc.xy, e = way.xy - b.arc.xy;
    float ra = length(a), re = length(e);
    if (ra > 0.0 && re > 0.0) {
      b.arc.z = 0.5 * (ra + re);
      b.from = a / ra;
      b.to = e / re;
      b.len = b.arc.z * abs(b.sweep);
    }
  }
#endif
  return b;
}

// A point of its path, from the eye.
vec3 pointOf(Bead b, float share) {
  vec3 p = b.start + vec3(b.along * b.len, b.climb) * share;
#ifdef ARCS
  if (b.arc.z > 0.0) {
    float c = cos(b.sweep * share), s = sin(b.sweep * share);
    p.xy = b.start.xy + b.arc.xy + b.arc.z * vec2(c * b.from.x - s * b.from.y, s * b.from.x + c * b.from.y);
  }
#endif
  return p;
}

// The box of a bead: from low to high along the path, across it, and up, from its start.
void boxOf(Bead b, out vec3 low, out vec3 high) {
  float reach = max(b.flat0, b.flat1) + b.radius;
  float tall = b.radius + b.side;
  float chord = b.len;
  low = vec3(-reach, -reach, -tall);
  high = vec3(reach, reach, tall);
#ifdef ARCS
  if (b.arc.z > 0.0) {
    vec2 end = b.arc.xy + b.arc.z * b.to;
    chord = dot(end, b.along);
    vec2 center = vec2(dot(b.arc.xy, b.along), dot(b.arc.xy, vec2(-b.along.y, b.along.x)));
    if (abs(b.sweep) >= 3.14159265) {
      low.xy = center - b.arc.z - reach;
      high.xy = center + b.arc.z + reach;
      chord = 0.0;
    } else {
      float bulge = center.y - sign(b.sweep) * b.arc.z;
      low.y = min(bulge, 0.0) - reach;
      high.y = max(bulge, 0.0) + reach;
    }
  }
#endif
  high.x += chord;
#ifdef SLOPES
  float steep = b.len > 0.0 ? sqrt(1.0 + b.climb * b.climb / (b.len * b.len)) : 1.0;
  if (b.climb != 0.0 && max(b.flat0, b.flat1) > 0.0) {
    low.z = -tall * 1.04 * steep;
    high.z = tall * steep;
  }
  low.z += min(b.climb, 0.0);
  high.z += max(b.climb, 0.0);
#endif
}

// Signed distance at a point from the start, and its gradient.
float field(Bead b, vec3 q, out vec3 gradient) {
  vec2 off;
  float half_flat = b.flat0;
#ifdef ARCS
  bool arc = b.arc.z > 0.0;
#else
  const bool arc = false;
#endif
#ifdef SLOPES
  if (!arc && b.flat0 == 0.0 && b.flat1 == 0.0) {
    vec3 d = vec3(b.along * b.len, b.climb);
    float dd = dot(d, d);
    vec3 e = q - d * (dd > 0.0 ? clamp(dot(q, d) / dd, 0.0, 1.0) : 0.0);
    float l = length(e);
    gradient = e / max(l, 1e-9);
    return l - b.radius;
  }
#endif
  float share = 0.0;
  bool inner = false;
#ifdef ARCS
  if (arc) {
    vec2 v = q.xy - b.arc.xy;
    float turn = sign(b.sweep);
    float past = turn * (b.from.x * v.y - b.from.y * v.x), before = turn * (v.x * b.to.y - v.y * b.to.x);
    float full = abs(b.sweep);
    bool within = full <= 3.14159265 ? past >= 0.0 && before >= 0.0 : past >= 0.0 || before >= 0.0 || full >= 6.2831852;
    float l = length(v);
    if (within) {
      off = v * (1.0 - b.arc.z / max(l, 1e-9));
#ifdef SLOPES
      float angle = turn * atan(b.from.x * v.y - b.from.y * v.x, dot(b.from, v));
      share = clamp((angle < 0.0 ? angle + 6.2831853 : angle) / full, 0.0, 1.0);
#endif
    } else {
      vec2 a = v - b.arc.z * b.from, e = v - b.arc.z * b.to;
      bool first = dot(a, a) <= dot(e, e);
      off = first ? a : e;
      share = first ? 0.0 : 1.0;
    }
  } else
#endif
  {
    float along = dot(q.xy, b.along);
#ifdef TAPERS
    float across = abs(q.y * b.along.x - q.x * b.along.y);
    float k = b.len > 0.0 ? (b.flat1 - b.flat0) / b.len : 0.0;
    along += across * k / sqrt(max(1.0 - k * k, 1e-6));
    half_flat = b.flat0 + k * clamp(along, 0.0, b.len);
#endif
    float s = clamp(along, 0.0, b.len);
    inner = s == along;
    off = q.xy - s * b.along;
    share = b.len > 0.0 ? s / b.len : 0.0;
  }
  float rho = length(off);
  float z = q.z;
  float cosine = 1.0;
#ifdef SLOPES
  if (b.climb != 0.0) {
    cosine = b.len / sqrt(b.len * b.len + b.climb * b.climb);
    z = (q.z - b.climb * share) * cosine;
    if (z < 0.0) z = min(z + 0.04 * (b.radius + b.side), 0.0);
  }
#endif
  float d = rho - half_flat;
  vec2 plan = off / max(rho, 1e-9);
  float distance;
#ifdef CORNERS
  float over = abs(z) - b.side;
  float x = max(d, 0.0), y = max(over, 0.0);
  float l = sqrt(x * x + y * y);
  distance = l + min(max(d, over), 0.0) - b.radius;
  if (l > 0.0) gradient = vec3(plan * x, sign(z) * y) / l;
  else gradient = d > over ? vec3(plan, 0.0) : vec3(0.0, 0.0, sign(z));
#else
  float x = max(d, 0.0);
  float l = sqrt(x * x + z * z);
  distance = l - b.radius;
  gradient = vec3(plan * x, z) / max(l, 1e-9);
#endif
#ifdef SLOPES
  if (b.climb != 0.0) {
    if (inner) gradient.xy -= b.along * (gradient.z * cosine * b.climb / b.len);
    gradient.z *= cosine;
  }
#endif
  return distance;
}

// The nearest hit along a direction whose part along the viewing direction is 1: its depth, and the normal.
// A straight bead is convex, so that Newton's steps from outside never pass the surface.
bool meets(Bead b, vec3 ray, out float depth, out vec3 normal) {
  vec3 low, high;
  boxOf(b, low, high);
  vec2 across = vec2(-b.along.y, b.along.x);
  vec3 o = -vec3(dot(b.start.xy, b.along), dot(b.start.xy, across), b.start.z);
  vec3 d = vec3(dot(ray.xy, b.along), dot(ray.xy, across), ray.z);
  d = mix(d, vec3(1e-9), lessThan(abs(d), vec3(1e-9)));
  vec3 t0 = (low - o) / d, t1 = (high - o) / d;
  vec3 near = min(t0, t1), far = max(t0, t1);
  float begin = max(max(near.x, near.y), max(near.z, 1e-3)), end = min(min(far.x, far.y), far.z);
  float plane = -1.0;
  float facing = dot(cut.xyz, ray);
  if (cut.xyz != vec3(0.0)) {
    float t = abs(facing) < 1e-12 ? 0.0 : cut.w / facing;
    if (facing < 0.0) {
      if (t > begin) begin = plane = t;
    } else if (facing > 0.0) end = min(end, t);
    else if (cut.w < 0.0) return false;
  }
  if (begin > end) return false;
  vec3 q = ray * begin - b.start;
  float t = 0.0;
  float close = 2e-3 * b.radius;
  float speed = length(ray);
  float f = field(b, q, normal);
  if (plane > 0.0 && f < 0.0) {
    depth = begin;
    normal = cut.xyz;
    return true;
  }
#ifdef ARCS
  if (b.arc.z > 0.0) {
    for (int n = 0; n < 64 && f > close; ++n) {
      t += max(f, close) / speed;
      if (begin + t > end) return false;
      f = field(b, q + ray * t, normal);
    }
  } else
#endif
  for (int n = 0; n < 12 && f > close; ++n) {
    float fall = dot(normal, ray);
    if (fall > -1e-5 * speed) return false;
    t -= f / fall;
    f = field(b, q + ray * t, normal);
  }
  if (f > 4.0 * close) return false;
  depth = begin + t;
  if (depth > end) return false;
  normal = normalize(normal);
  return true;
}`;

// Which of the beads are drawn: of a range, or of a list of them.
const CHOICE = `
uniform usampler2D shown;   // by run
uniform usampler2D list;    // of beads; used if from_list
uniform bool from_list;
uniform uint first;         // of the draw
uniform uint end;           // beads that are printed
uint chosen(uint n) { return from_list ? row(list, first + n).x : first + n; }
uint shownAs(uint n) { return n < end ? row(shown, row(beads, n).w >> 13u).x : 0u; } // see BeadTable.shown()
bool isShown(uint n) { return shownAs(n) != 0u; }`;

/** Both, of a table that has these kinds of beads. */
export const bead = (kinds) =>
  ["arcs", "tapers", "slopes", "corners", "extras"].filter((kind) => kinds[kind]).map((kind) => `#define ${kind.toUpperCase()}\n`).join("") + BEAD + CHOICE;

/** Beads of the table, or of a list: each a rectangle in the plane of the side of its box that faces the eye most, large enough
 * to hide the box, and as near as its nearest corner. Of a bead that passes the eye it is only what lies before that. */
export const beadVertices = (kinds) => `${HEAD}
${bead(kinds)}
flat out uint id;
flat out Bead body;
void main() {
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  uint n = chosen(uint(gl_VertexID >> 2));
  id = n + 1u;
  if (!isShown(n)) return;
  body = beadAt(n);
  vec3 low, high;
  boxOf(body, low, high);
  vec2 across = vec2(-body.along.y, body.along.x);
  vec3 start = vec3(dot(body.start.xy, body.along), dot(body.start.xy, across), body.start.z);
  low += start;
  high += start;
  // How far the sides are before the eye, and how that is to the sides behind: the box from there is so much smaller.
  vec3 away = max(low, -high), shares = away / max(high, -low);
  float share = max(max(shares.x, shares.y), shares.z);
  bvec3 facing = equal(shares, vec3(share));
  vec2 at = vec2(gl_VertexID & 1, gl_VertexID >> 1 & 1) * 2.0 - 1.0;
  vec3 corner = facing.x ? vec3(0.0, at) : facing.y ? vec3(at.x, 0.0, at.y) : vec3(at, 0.0);
  facing = equal(corner, vec3(0.0));
  if (dot(away, vec3(facing)) < 1e-3) {
    gl_Position = vec4(at, 1.0, 1.0); // the eye is in the box
    return;
  }
  vec3 p = mix(mix(max(high, high * share), min(low, low * share), lessThan(corner, vec3(0.0))), mix(high, low, greaterThan(low, vec3(0.0))), facing);
  p.xy = body.along * p.x + across * p.y;
  vec3 way = vec3(dot(forward.xy, body.along), dot(forward.xy, across), forward.z);
  float depth = dot(p, forward), nearest = max(dot(min(low * way, high * way), vec3(1.0)), ${NEAR});
  gl_Position = vec4(vec2(dot(p, right), dot(p, up)) / slope, min(1.0, 2.0 * ${NEAR} / nearest * 1.001 - 1.0) * depth, depth);
}`;

/** Of each bead, a point of a table: whether a point of its upper (or lower) or of its near side is not behind what the
 * picture shows there. */
export const seekVertices = (kinds) => `${HEAD}
${bead(kinds)}
uniform sampler2D depths;
uniform vec2 size;          // pixels
uniform float shift;        // 0 to 1, of the points along the bead
bool isAhead(vec3 p, Bead b) {
  float tolerance = 0.5 * b.radius;
  if (cut.xyz != vec3(0.0) && dot(cut.xyz, p) > cut.w + tolerance) return false;
  float depth = dot(p, forward);
  if (depth <= 1e-3) return false;
  vec2 at = (0.5 + 0.5 * vec2(dot(p, right), dot(p, up)) / (depth * slope)) * size;
  if (any(lessThan(at, vec2(0.0))) || any(greaterThanEqual(at, size))) return false;
  tolerance += min(2.0 * depth * slope.y / size.y, b.radius); // a pixel
  return depth - tolerance < ${NEAR} / max(texelFetch(depths, ivec2(at), 0).x, 1e-9);
}
bool inSight(Bead b) {
  float reach = max(b.flat0, b.flat1) + b.radius;
  int points = clamp(int(b.len), 2, 5);
  for (int n = 0; n < points; ++n) {
    vec3 p = pointOf(b, (float(n) + shift) / float(points));
    vec3 level = vec3(0.0, 0.0, p.z < 0.0 ? b.radius + b.side : -b.radius - b.side);
    vec3 beside = vec3(-reach * p.xy / max(length(p.xy), 1e-6), 0.0);
    if (isAhead(p + level, b) || isAhead(p + beside, b)) return true;
  }
  return false;
}
void main() {
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  gl_PointSize = 1.0;
  uint n = chosen(uint(gl_VertexID));
  if (!isShown(n) || !inSight(beadAt(n))) return;
  vec2 place = vec2(gl_VertexID & ${ROW - 1}, gl_VertexID >> ${ROW_BITS}) + 0.5;
  gl_Position = vec4(2.0 * place / vec2(${ROW}, ${SOUGHT / ROW}) - 1.0, 0.0, 1.0);
}`;
export const seekFragments = `${HEAD}
out vec4 found;
void main() { found = vec4(1.0); }`;

/** Which bead is nearest, with its normal (see packed()) and its exact depth (1 near the eye, 0 far away). */
export const beadFragments = (kinds) => `${HEAD}
${bead(kinds)}
uniform vec2 size;          // pixels
flat in uint id;
flat in Bead body;
layout(location = 0) out uint bead;
layout(location = 1) out uint facing;
#ifdef GL_EXT_conservative_depth
layout(depth_less) out highp float gl_FragDepth;
#endif
void main() {
  vec2 at = (2.0 * gl_FragCoord.xy / size - 1.0) * slope;
  float depth;
  vec3 normal;
  if (!meets(body, forward + at.x * right + at.y * up, depth, normal)) discard;
  bead = id;
  facing = packed(normal);
  gl_FragDepth = min(1.0, ${NEAR} / depth);
}`;
