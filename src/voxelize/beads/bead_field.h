// The exact field of one bead, and the distance in the plan (xy) that it is computed from.
//
// With rho the plan distance to the path and c = (width - height) / 2, a level bead is a capsule in xy, swept by a ball
//     phi(p) = hypot(max(rho - c, 0), z - z_c) - height / 2        (mm, negative inside)
// which is the exact signed distance outside. It is column-separable: rho does not depend on z. A section with corners
// of radius r < height / 2 has straight sides of height 2 a, a = height / 2 - r:
//     phi(p) = hypot(max(d, 0), max(|z - z_c| - a, 0)) + min(max(d, |z - z_c| - a), 0) - r,     d = rho - c
#pragma once

#include "gcode/toolpath/plan_path.h"
#include "gcode/toolpath/toolpath.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>

namespace stratum::voxelize {

/// Axis-aligned box in print space, mm.
struct Bounds {
    double min[3] = {1e300, 1e300, 1e300};
    double max[3] = {-1e300, -1e300, -1e300};

    void include(const Bounds& other) {
        for (int axis = 0; axis < 3; ++axis) {
            min[axis] = std::min(min[axis], other.min[axis]);
            max[axis] = std::max(max[axis], other.max[axis]);
        }
    }
    double extent(int axis) const { return max[axis] - min[axis]; }
    double center(int axis) const { return 0.5 * (min[axis] + max[axis]); }
};

/// From a lowest to a highest point of a bead's solid, mm.
struct Extent {
    double z_min = 0, z_max = 0;
};

/// Cross-section of a bead: the flats reach half_flat to each side of the path, the corners have `radius`, the straight
/// sides between them the height 2 half_side, and the center line runs `drop` below the nozzle. All mm. half_flat is 0
/// for a round bead; half_side is 0 for it and for a stadium.
struct Section {
    double half_flat = 0;
    double radius = 0;
    double half_side = 0;
    double drop = 0;

    double halfHeight() const { return radius + half_side; }
    double halfWidth() const { return half_flat + radius; }
};

/// Half the width of a stadium less half the flat of a section of the same area and height, mm: the radius for the
/// stadium itself. With corners of radius r: w = (area + (4 - pi) r^2) / height, and the flat is w - 2 r.
double flatInset(double height, double radius);

Section sectionOf(const gcode::Toolpath& toolpath, const gcode::Bead& bead);

/// Half the flat (mm) at the two ends of a bead. They differ where a level straight bead widens (gcode::BeadFlow): then
/// the bead is swept by a section whose flat changes linearly, and with s the position along the path
///     d = min over s of |p - path(s)| - half_flat(s)
/// which is closed form, since the nearest s lies a constant angle off the perpendicular.
struct EndFlats {
    double start = 0, end = 0;
};
/// `bead` is an element of Toolpath::beads.
EndFlats endFlats(const gcode::Toolpath& toolpath, const gcode::Bead& bead, double mean);

/// How far a sloped bead is extended below its underside, as a fraction of its height, to weld it to the layer below.
constexpr double kSlopedReach = 0.02;

/// The field of one bead, level or sloped.
///
/// A sloped bead scales the vertical offset by the cosine of its slope, which is exact on its long sides and, at slope
/// angle a, off by at most height / 2 * tan(a) near its two ends. Paths steeper than 45 degrees can't lay flats: they
/// become round rods of the same section area. Round straight beads are exact 3-D capsules at any slope.
class BeadField {
public:
    /// `bead` is an element of Toolpath::beads.
    BeadField(const gcode::Toolpath& toolpath, const gcode::Bead& bead);

    /// Signed distance (mm, negative inside) at a point of print space (mm).
    double distance(double x, double y, double z) const;

    /// What a vertical line meets of the solid: one piece, for the solid is convex along z. Nothing if it misses.
    std::optional<Extent> heights(double x, double y) const;

    /// Box of the solid, mm.
    Bounds bounds() const;
    /// Box of the solid turned by `tilt` degrees about x, mm: as tight as bounds(), but of helices.
    Bounds bounds(double tilt) const;

    const gcode::PlanPath& path() const { return path_; }
    /// Distance in the plan to the flat, mm: negative over it.
    double planOffset(double x, double y) const;
    /// The mean, if the bead widens.
    double halfFlat() const { return half_flat_; }
    double radius() const { return radius_; }
    /// Half the height of the straight sides, mm; see Section.
    double halfSide() const { return half_side_; }
    bool level() const { return level_; }
    /// A straight round bead: a capsule in 3-D.
    bool rod() const { return rod_; }
    /// Of the slope's angle; 1 for a level bead.
    double cosine() const { return cosine_; }
    /// How far the underside is extended downwards, mm; see kSlopedReach.
    double reach() const { return reach_; }

private:
    std::optional<Extent> rodHeights(double x, double y) const;

    gcode::PlanPath path_;
    double half_flat_, radius_, half_side_;
    EndFlats flats_;
    double x0_, y0_, dx_, dy_;  // mm, center line in the plane
    double zc0_, zc1_;          // mm, center line at the start and the end
    double cosine_ = 1, reach_ = 0;
    bool level_ = true, rod_ = false;
};

/// Box of the solid of all listed beads, mm, turned by `tilt` degrees about x. There must be one. Parallel.
Bounds boundsOf(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> beads, double tilt = 0);

}  // namespace stratum::voxelize
