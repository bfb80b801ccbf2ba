// The shaders of light: on the beads that the first pass has found, on the bed, and behind.
import { HEAD, NEAR } from "./bead_shaders.js";

export const screenVertices = `${HEAD}
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }`;

// The backdrop and the bed's light, and how bright that looks.
export const STAGE = `
uniform vec3 bed_albedo, horizon, zenith;
uniform vec2 turned;        // cosine and sine by which the light has turned with the camera
uniform float brightest, scale, bed_z;
uniform bool has_bed;
uniform vec4 fade;          // the bed's: center from the eye, begin, end
uniform sampler2D light;    // octahedral: light on a matt surface by its normal, and on a glossy one by the mirror's way

vec2 lightAt(vec3 way) {
  way.xy = vec2(turned.x * way.x + turned.y * way.y, turned.x * way.y - turned.y * way.x);
  float side = float(textureSize(light, 0).x);
  return textureLod(light, (octahedral(way) * (side - 1.0) + 0.5) / side, 0.0).xy;
}
vec3 display(vec3 c) {      // Khronos PBR Neutral, as tonemap.cpp, and sRGB
  c = max(c * scale, vec3(0.0));
  float low = min(c.r, min(c.g, c.b));
  c -= low < 0.08 ? low - 6.25 * low * low : 0.04;
  float peak = max(c.r, max(c.g, c.b));
  float lower = 1.0 - 0.0576 / (max(peak, 0.76) - 0.52);
  float white = 1.0 - 1.0 / (0.15 * (peak - lower) + 1.0);
  c = peak < 0.76 ? c : mix(c * lower / max(peak, 1e-6), vec3(lower), white);
  return mix(12.92 * c, 1.055 * pow(max(c, vec3(1e-6)), vec3(1.0 / 2.4)) - 0.055, greaterThan(c, vec3(0.0031308)));
}
vec3 backdrop(vec3 ray) {
  float t = clamp(normalize(ray).z, 0.0, 1.0);
  return mix(horizon, zenith, t * t * (3.0 - 2.0 * t));
}
float bedFade(vec2 place) {
  float r = clamp((length(place - fade.xy) - fade.z) / (fade.w - fade.z), 0.0, 1.0);
  return r * r * r * (r * (6.0 * r - 15.0) + 10.0);
}`;

/** What is behind the print: it changes slowly, so its light is found at the corners of a grid. */
export const GRID = [24, 18];
export const backVertices = `${HEAD}
uniform vec3 right, up, forward;
uniform vec2 slope;
uniform bool as_normals;
${STAGE}
out vec3 shade;
out vec3 ray;
void main() {
  ivec2 at = ivec2(gl_VertexID % ${GRID[0] + 1}, gl_VertexID / ${GRID[0] + 1});
  vec2 place = 2.0 * vec2(at) / vec2(${GRID[0]}, ${GRID[1]}) - 1.0;
  gl_Position = vec4(place, -1.0, 1.0); // as far as a depth can be
  shade = vec3(0.0);
  ray = forward + place.x * slope.x * right + place.y * slope.y * up;
  if (as_normals) return;
  vec3 behind = backdrop(ray);
  float to_bed = has_bed && ray.z < 0.0 ? bed_z / ray.z : 1e30;
  vec3 bed = brightest * bed_albedo * lightAt(vec3(0.0, 0.0, 1.0)).x;
  shade = display(mix(bed, behind, to_bed < 1e29 ? bedFade(ray.xy * to_bed) : 1.0));
}`;
/** `over`: a quick picture of the beads lies over it, which costs less here than a copy of that to the canvas. */
export const backFragments = (over) => `${HEAD}
in vec3 shade;
${output(over)}
void main() { show(shade); }`;
/** The same with the lines of a bed that has a grid. */
export const gridFragments = (over) => `${HEAD}
uniform vec2 slope, size;
uniform vec3 eye;
uniform vec2 corner;        // of the table: the bed's lines count from the origin
uniform float bed_z;
uniform vec4 fade;
in vec3 shade;
in vec3 ray;
${output(over)}
void main() {
  show(shade);
  if (ray.z >= 0.0) return;
  float depth = bed_z / ray.z;
  vec2 mm = ray.xy * depth + eye.xy + corner;
  float pixel = depth * slope.y / size.y * 2.0;
  vec2 fine = abs(mm - 10.0 * round(mm / 10.0)), broad = abs(mm - 50.0 * round(mm / 50.0));
  float a = max(1.0 - min(fine.x, fine.y) / max(0.2, pixel), 0.0) * clamp(1.0 - pixel / 3.0, 0.0, 1.0);
  float b = max(1.0 - min(broad.x, broad.y) / max(0.4, 1.5 * pixel), 0.0) * clamp(1.0 - pixel / 15.0, 0.0, 1.0);
  show(mix(shade, vec3(0.62), 0.6 * max(a, b) * (1.0 - clamp(length(ray.xy * depth - fade.xy) / fade.w, 0.0, 1.0))));
}`;
const output = (over) => (over ? `
uniform sampler2D picture;
out vec4 color;
void show(vec3 behind) {
  color = texelFetch(picture, ivec2(gl_FragCoord.xy), 0);
  if (color.a == 0.0) color = vec4(behind, 1.0);
}` : "out vec4 color;\nvoid show(vec3 behind) { color = vec4(behind, 1.0); }");

/** The colour of a bead under that light. */
export const COLORED = `
uniform usampler2D colors;  // by bead, places of the palette
uniform sampler2D palette;
uniform bool colored, as_normals;
uniform vec3 albedo;
vec3 bodyOf(uint n) {
  if (!colored) return albedo;
  uint place = row(colors, n).x;
  return texelFetch(palette, ivec2(place & 1023u, place >> 10u), 0).rgb;
}
// Grooves between layers, and what is far off, keep some off.
vec3 shadeOf(vec3 body, vec3 normal, vec3 ray, float open) {
  if (as_normals) return 0.5 * normal + 0.5;
  return display(open * brightest * (body * lightAt(normal).x + 0.04 * lightAt(reflect(ray, normal)).y));
}
float openness(vec3 normal) { return 0.7 + 0.2 * abs(normal.z); }`;

/** The light on the beads that the first pass has found, and their shadow on the bed about them. */
export const lightFragments = `${HEAD}
${STAGE}
${COLORED}
uniform vec3 right, up, forward;
uniform vec2 slope;         // tangents of half the angles of the picture
uniform usampler2D beads, runs;
uniform usampler2D normals;
uniform usampler2D ids;
uniform sampler2D depths;
uniform vec2 size;
uniform float reach;        // mm: what is farther away keeps no light off
out vec4 color;

vec3 rayAt(vec2 pixel) { vec2 at = (2.0 * pixel / size - 1.0) * slope; return forward + at.x * right + at.y * up; }
float depthAt(ivec2 pixel) { return ${NEAR} / max(texelFetch(depths, clamp(pixel, ivec2(0), ivec2(size) - 1), 0).x, 1e-9); }

// The surface over a few pixels: where layers are thinner than those, their normals would flicker.
vec3 broadNormal(ivec2 pixel, float depth, vec3 normal) {
  vec3 here = rayAt(vec2(pixel) + 0.5) * depth;
  vec3 way[2];
  for (int axis = 0; axis < 2; ++axis) {
    ivec2 step = axis == 0 ? ivec2(3, 0) : ivec2(0, 3);
    float a = depthAt(pixel + step), b = depthAt(pixel - step);
    bool ahead = abs(a - depth) < abs(b - depth);
    vec3 there = rayAt(vec2(ahead ? pixel + step : pixel - step) + 0.5) * (ahead ? a : b);
    way[axis] = ahead ? there - here : here - there;
  }
  vec3 broad = cross(way[0], way[1]);
  return dot(broad, broad) > 0.0 ? normalize(broad) : normal;
}
// Share of the light that the surroundings keep off. After McGuire et al., "Scalable Ambient Obscurance", HPG 2012.
float hidden(ivec2 pixel, vec3 here, vec3 normal, float depth) {
  float spread = clamp(reach / (depth * slope.y) * 0.5 * size.y, 4.0, 0.2 * size.y);
  float sum = 0.0;
  for (int n = 0; n < 10; ++n) {
    float angle = float(n) * 2.399963 + 0.4, share = sqrt((float(n) + 0.6) / 10.0);
    ivec2 there = pixel + ivec2(share * share * spread * vec2(cos(angle), sin(angle)));
    vec3 v = rayAt(vec2(there) + 0.5) * min(depthAt(there), 4.0 * depth) - here;
    float vv = dot(v, v);
    float f = max(1.0 - vv / (reach * reach), 0.0);
    sum += f * f * max(dot(v, normal) * inversesqrt(vv + 1e-6) - 0.1, 0.0);
  }
  return min(sum * 0.2, 0.85);
}

// Software runs both sides of a branch for all pixels, but no loop that none enters: hence loops of one round.
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec3 ray = rayAt(gl_FragCoord.xy);
  uint id = texelFetch(ids, pixel, 0).x;
  color = vec4(0.0);
  for (bool bead = id != 0u; bead; bead = false) {
    vec3 normal = unpacked(texelFetch(normals, pixel, 0).x);
    vec3 shading = normal;
    float open = openness(normal);
    float depth = depthAt(pixel);
    uint word = row(beads, id - 1u).w;
    float thin = min(float(word & 4095u) * 0.004, uintBitsToFloat(row(runs, word >> 13u).x));
    vec3 broad = broadNormal(pixel, depth, normal);
    float pixel_mm = depth * slope.y / size.y * 2.0;
    shading = normalize(mix(normal, broad, 0.9 * smoothstep(0.25, 0.9, pixel_mm / thin)));
    open *= 1.0 - hidden(pixel, ray * depth, broad, depth);
    color = vec4(shadeOf(bodyOf(id - 1u), as_normals ? normal : shading, normalize(ray), open), 1.0);
  }
  for (bool bed = id == 0u && has_bed && !as_normals && ray.z < 0.0; bed; bed = false) {
    float depth = bed_z / ray.z;
    color.a = hidden(pixel, ray * depth, vec3(0.0, 0.0, 1.0), depth) * (1.0 - bedFade(ray.xy * depth));
  }
}`;
