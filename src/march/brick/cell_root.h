// Finds where a ray crosses zero inside one cell: the trilinear field along a segment is a cubic.
//
// After Marmitt et al., "Fast and Accurate Ray-Voxel Intersection Techniques for Iso-Surface Ray Tracing" (VMV 2004),
// and Hansson-Soderlund, Evans, Akenine-Moller, "Ray Tracing of Signed Distance Function Grids" (JCGT 11(3), 2022).
#pragma once

#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace stratum::march {

/// Values at the corners of a cell; index x << 2 | y << 1 | z.
using Corners = std::array<double, 8>;

/// The trilinear interpolant at `p` in [0, 1]^3. At a coordinate of exactly 0 or 1 the far corners have weight 0, so
/// that two cells get the same bits on the face that they share.
inline double interpolate(const Corners& v, const glm::dvec3& p) {
    const double x1 = p.x;
    const double x0 = 1 - p.x;
    const double y1 = p.y;
    const double y0 = 1 - p.y;
    const double y0z0 = v[0] * x0 + v[4] * x1;
    const double y0z1 = v[1] * x0 + v[5] * x1;
    const double y1z0 = v[2] * x0 + v[6] * x1;
    const double y1z1 = v[3] * x0 + v[7] * x1;
    return (y0z0 * y0 + y1z0 * y1) * (1 - p.z) + (y0z1 * y0 + y1z1 * y1) * p.z;
}

/// Its gradient, per cell.
inline glm::dvec3 gradient(const Corners& v, const glm::dvec3& p) {
    const double x0 = 1 - p.x;
    const double y0 = 1 - p.y;
    const double z0 = 1 - p.z;
    return {y0 * (z0 * (v[4] - v[0]) + p.z * (v[5] - v[1])) + p.y * (z0 * (v[6] - v[2]) + p.z * (v[7] - v[3])),
            x0 * (z0 * (v[2] - v[0]) + p.z * (v[3] - v[1])) + p.x * (z0 * (v[6] - v[4]) + p.z * (v[7] - v[5])),
            x0 * (y0 * (v[1] - v[0]) + p.y * (v[3] - v[2])) + p.x * (y0 * (v[5] - v[4]) + p.y * (v[7] - v[6]))};
}

/// The field along the segment from `from` to `to` (both in [0, 1]^3), s from 0 to 1: c0 + c1 s + c2 s^2 + c3 s^3.
struct SegmentCubic {
    double c0, c1, c2, c3;
    /// The value at s = 1, interpolated there instead of summed up, so that neighbouring cells agree on it.
    double end;

    SegmentCubic(const Corners& v, const glm::dvec3& from, const glm::dvec3& to)
        : c0(interpolate(v, from)), end(interpolate(v, to)) {
        const double kx = v[4] - v[0];
        const double ky = v[2] - v[0];
        const double kz = v[1] - v[0];
        const double kxy = v[6] - v[4] - ky;
        const double kzx = v[5] - v[4] - kz;
        const double kyz = v[3] - v[2] - kz;
        const double kxyz = v[7] - v[6] - v[5] + v[4] - kyz;
        const double a = to.x - from.x;
        const double b = to.y - from.y;
        const double c = to.z - from.z;
        c3 = kxyz * a * b * c;
        c2 = a * b * (kxy + kxyz * from.z) + b * c * (kyz + kxyz * from.x) + a * c * (kzx + kxyz * from.y);
        c1 = a * (kx + kxy * from.y + kzx * from.z + kxyz * from.y * from.z) +
             b * (ky + kxy * from.x + kyz * from.z + kxyz * from.x * from.z) +
             c * (kz + kzx * from.x + kyz * from.y + kxyz * from.x * from.y);
    }
    double operator()(double s) const { return ((c3 * s + c2) * s + c1) * s + c0; }
    double slope(double s) const { return (3 * c3 * s + 2 * c2) * s + c1; }
    /// Half the second derivative.
    double bend(double s) const { return 3 * c3 * s + c2; }
};

inline bool isInside(double value) { return value < 0; }

/// The first interval of [0, 1] in which the field changes sign exactly once, or nothing. Equal signs at both ends do
/// not mean that there is none: the interval is split where the slope vanishes.
inline std::optional<std::pair<double, double>> firstCrossing(const SegmentCubic& f) {
    const bool in0 = isInside(f.c0);
    const bool in3 = isInside(f.end);
    // Bernstein coefficients enclose the curve and bound its sign changes by theirs. The two inner ones times 3: a sign
    // needs no division.
    const bool in1 = isInside(3 * f.c0 + f.c1);
    const bool in2 = isInside(3 * f.c0 + (2 * f.c1 + f.c2));
    const int changes = static_cast<int>(in0 != in1) + static_cast<int>(in1 != in2) + static_cast<int>(in2 != in3);
    if (changes == 0) return std::nullopt;
    if (changes == 1) return std::pair{0.0, 1.0};
    // Roots of 3 c3 s^2 + 2 c2 s + c1 in (0, 1), in the form that doesn't cancel.
    double extrema[2];
    int count = 0;
    const double discriminant = f.c2 * f.c2 - 3 * f.c3 * f.c1;
    if (discriminant > 0) {
        const double q = -(f.c2 + std::copysign(std::sqrt(discriminant), f.c2));
        for (const double root : {q / (3 * f.c3), f.c1 / q})
            if (root > 0 && root < 1) extrema[count++] = root;
        if (count == 2 && extrema[1] < extrema[0]) std::swap(extrema[0], extrema[1]);
    }
    double low = 0;
    for (int n = 0; n < count; ++n) {
        if (isInside(f(extrema[n])) != in0) return std::pair{low, extrema[n]};
        low = extrema[n];
    }
    if (in3 != in0) return std::pair{low, 1.0};
    return std::nullopt;
}

/// The last step of refineRoot(), in lengths of the segment. Halley's steps cube the error, so after one this short
/// only rounding errors remain.
inline constexpr double kRootStep = 1e-6;
/// A step towards the crossing may end so far beyond the bracket, by rounding: zeros at an end are common, because
/// layers are printed on planes of voxels. A step away from it heads for another zero, outside the bracket, which may
/// be as near: where two layers touch, a field can come to -1e-16 and turn.
inline constexpr double kRootRounding = 0x1p-40;
/// The first step begins at least so far from both ends, in lengths of the bracket.
inline constexpr double kRootMargin = 0x1p-10;
inline constexpr int kRootSteps = 60;

/// The zero in a bracket from firstCrossing(): Halley's steps where they stay inside, else bisection. The number of
/// steps is bounded.
inline double refineRoot(const SegmentCubic& f, std::pair<double, double> bracket) {
    auto [low, high] = bracket;
    const bool in_low = low == 0 ? isInside(f.c0) : isInside(f(low));
    const double at_low = low == 0 ? f.c0 : f(low);
    const double at_high = high == 1 ? f.end : f(high);
    // Starts at the chord's zero, but not at an end: the value there may be 0 but for rounding, and the crossing
    // elsewhere.
    const double chord = low + (high - low) * at_low / (at_low - at_high);
    const double margin = kRootMargin * (high - low);
    double s = std::min(std::max(chord, low + margin), high - margin);
    for (int n = 0; n < kRootSteps; ++n) {
        const double value = f(s);
        const double slope = f.slope(s);
        const double step = value * slope / (slope * slope - value * f.bend(s));
        if (value == 0) return s;
        const bool before = isInside(value) == in_low;  // s, of the crossing
        (before ? low : high) = s;
        double next = s - step;
        // A step of 0 with a value that isn't: the slope is 0.
        if (step != 0 && next >= low - (before ? 0 : kRootRounding) && next <= high + (before ? kRootRounding : 0)) {
            next = std::min(std::max(next, low), high);
            if (std::abs(step) <= kRootStep) return next;
        } else {
            next = 0.5 * (low + high);
            if (next == low || next == high) return next;
        }
        s = next;
    }
    return s;
}

}  // namespace stratum::march
