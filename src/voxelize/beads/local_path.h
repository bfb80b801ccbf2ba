// A bead's path relative to the middle of one leaf column, in numbers small enough for floats.
//
// A float represents a coordinate of a metre to 0.06 um only, and a difference of two such coordinates is no more
// precise. So coordinates are subtracted in double, once for each bead and column; the results are of the size of a
// leaf.
#pragma once

#include "gcode/toolpath/plan_path.h"
#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/bead_field.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

namespace stratum::voxelize {

/// A straight path. With q the point relative to the middle of the column: the distance to the line is
/// |n0 + nx qx + ny qy|, the position along it s = ux qx + uy qy, and the segment is lo <= s <= hi. World units.
struct LocalLine {
    float nx, ny, n0;
    float ux, uy, lo, hi;
    float half_flat;
    bool spans;  ///< the segment's ends lie beyond all samples of the column, so they can be ignored

    /// From the middle of the column to the flat; below 0 within it.
    double fromMiddle() const {
        const double past = std::max({static_cast<double>(lo), -static_cast<double>(hi), 0.0});
        return std::sqrt(static_cast<double>(n0) * static_cast<double>(n0) + past * past) -
               static_cast<double>(half_flat);
    }
};

/// A straight path whose half flat changes linearly: flat + slope (s - flat_at) at the position s. The nearest section
/// of a point at the distance n from the line lies `lean` n farther along than the point.
struct LocalTaper {
    LocalLine line;  ///< half_flat: the larger end's
    float flat, flat_at, slope, lean;
};

/// A circular path of one column. |v0 + q| - radius, with v0 the middle of the column from the center, is written so
/// that a large radius cancels nothing: (2 e.q + k q^2) / (1 + sqrt(1 + k (2 e.q + k q^2))) + rho0, e = v0 / |v0|,
/// k = 1 / |v0|. Near the center, where e turns quickly, |v0 + q| - radius is small numbers anyway.
struct LocalArc {
    float ex, ey, k, rho0;
    float vx, vy, radius;                  ///< used when `near_center`
    float start_x, start_y, end_x, end_y;  ///< ends relative to the middle of the column
    // Half planes of the sweep: past the start where sx qx + sy qy + s0 >= 0, before the end where tx qx + ty qy + t0
    // >= 0.
    float sx, sy, s0, tx, ty, t0;
    float half_flat;
    bool near_center;
    bool wide;  ///< sweeps more than half a turn: the half planes' union, else their intersection
    bool full;  ///< a whole turn: no ends
};

/// The bead's path if it is an arc.
std::optional<gcode::PlanPath> arcOf(const gcode::Toolpath& toolpath, const gcode::Bead& bead);

/// `x`, `y` (mm): the middle of the column's samples. `half_extent` (mm): its samples lie within that in x and y.
/// `scale`: world units a mm. `half_flat` in mm.
LocalLine localLine(const gcode::Bead& bead, double half_flat, double x, double y, double half_extent, double scale);
/// `flats`: half the flat at the ends, mm. The path is longer than their difference.
LocalTaper localTaper(const gcode::Bead& bead, const EndFlats& flats, double x, double y, double half_extent,
                      double scale);
/// `path`: an arc.
LocalArc localArc(const gcode::PlanPath& path, double half_flat, double x, double y, double half_extent, double scale);

/// Beads of a column are scattered in memory: asks for one that is used soon.
inline void prefetchBead(const gcode::Toolpath& toolpath, std::uint32_t index) {
    const gcode::Bead& bead = toolpath.beads[index];
    __builtin_prefetch(&bead);
    __builtin_prefetch(&bead.width);  // most beads lie across two lines of the cache
    if (!toolpath.flow.empty()) __builtin_prefetch(&toolpath.flow[index]);
}

}  // namespace stratum::voxelize
