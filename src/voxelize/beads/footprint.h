// Finds the square columns that a bead reaches in the plan.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/settling.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace stratum::voxelize {

/// Rectangle of columns [i0, i1] x [j0, j1].
struct ColumnRange {
    int i0 = std::numeric_limits<int>::max();
    int i1 = std::numeric_limits<int>::min();
    int j0 = std::numeric_limits<int>::max();
    int j1 = std::numeric_limits<int>::min();

    bool empty() const { return i0 > i1; }
    void include(const ColumnRange& other) {
        i0 = std::min(i0, other.i0);
        i1 = std::max(i1, other.i1);
        j0 = std::min(j0, other.j0);
        j1 = std::max(j1, other.j1);
    }
};

/// The area within `reach` of a straight path in the plan, row by row. Lengths in mm.
class PlanCapsule {
public:
    PlanCapsule(const gcode::Bead& bead, double reach)
        : x0_(bead.x0), y0_(bead.y0), x1_(bead.x1), y1_(bead.y1), reach_(reach) {
        // From the lower end to the upper one; a level path from left to right.
        if (y0_ > y1_ || (y0_ == y1_ && x0_ > x1_)) {
            std::swap(x0_, x1_);
            std::swap(y0_, y1_);
        }
        const double dx = x1_ - x0_;
        const double dy = y1_ - y0_;
        const double length = std::sqrt(dx * dx + dy * dy);
        side_x_ = length > 0 ? dy / length * reach : 0;
        side_y_ = length > 0 ? dx / length * reach : reach;
        slope_ = dy > 0 ? dx / dy : 0;  // rows between both ends of a side are of dy > 0
    }

    bool meets(double y) const { return y >= y0_ - reach_ && y <= y1_ + reach_; }
    /// The ends of a row that the area meets: on a straight side between its ends, on a disc elsewhere.
    double left(double y) const { return side(y, -side_x_, side_y_, -1); }
    double right(double y) const { return side(y, side_x_, -side_y_, 1); }

private:
    double side(double y, double side_x, double side_y, double sign) const {
        const auto disc = [&](double center_x, double center_y) {
            const double h2 = reach_ * reach_ - (y - center_y) * (y - center_y);
            return center_x + sign * std::sqrt(std::max(h2, 0.0));
        };
        if (y <= y0_ + side_y) return disc(x0_, y0_);
        if (y >= y1_ + side_y) return disc(x1_, y1_);
        return x0_ + side_x + (y - (y0_ + side_y)) * slope_;
    }

    double x0_, y0_, x1_, y1_;
    double reach_;
    double side_x_, side_y_;  // from the path to its right side, the latter downwards
    double slope_;            // dx / dy
};

/// Visits the square columns that beads reach. A column is reached if the center of its samples is within limit() of
/// the path: no sample is farther from that center than half the diagonal they span.
class Footprints {
public:
    /// What of a bead reaches a column.
    enum class Reach : std::uint8_t {
        solid,  ///< its solid and the band around it
        field,  ///< the same, and the grooves that it may fill where beads settle: two radii from its flat
    };

    /// All mm: columns are `edge` wide, from multiples of it; their samples span twice `half_span`; the band is `band`
    /// wide.
    Footprints(const gcode::Toolpath& toolpath, double edge, double half_span, double band, Reach reach)
        : toolpath_(toolpath),
          edge_(edge),
          half_(half_span),
          per_edge_(1 / edge),
          fills_grooves_(reach == Reach::field && toolpath.deposit.settles()),
          swell_(toolpath.deposit.swells() ? kMostSwell * settlingScale(toolpath) : 0),
          band_(band),
          // The part in 1e9 makes rounding conservative.
          slack_((band + half_span * std::sqrt(2.0)) * (1 + 1e-9)) {}

    /// How far from its path a bead reaches the centers of columns, mm.
    double limit(const gcode::Bead& bead) const {
        const Section section = sectionOf(toolpath_, bead);
        const double radius = radiusOf(bead, section);
        const double more = fills_grooves_ ? std::max(radius - band_, 0.0) : 0;
        const EndFlats flats = endFlats(toolpath_, bead, section.half_flat);
        return std::max(flats.start, flats.end) + radius + more + swell_ + slack_;
    }

    /// Columns whose centers lie in the box of the path, enlarged by `limit` on each side.
    ColumnRange range(const gcode::Bead& bead, double limit) const {
        double min[2] = {std::min(bead.x0, bead.x1), std::min(bead.y0, bead.y1)};
        double max[2] = {std::max(bead.x0, bead.x1), std::max(bead.y0, bead.y1)};
        if (bead.arc >= 0) gcode::PlanPath(toolpath_, bead).bounds(min, max);
        return {first(min[0] - limit), last(max[0] + limit), first(min[1] - limit), last(max[1] + limit)};
    }

    /// Calls visit(i0, i1, j) for the columns [i0, i1] of each row j.
    template <typename Visit>
    void forEachColumn(const gcode::Bead& bead, Visit visit) const {
        const double reach = limit(bead);
        const ColumnRange columns = range(bead, reach);
        if (bead.arc >= 0) {
            const gcode::PlanPath path(toolpath_, bead);
            for (int j = columns.j0; j <= columns.j1; ++j)
                forEachNearRing(bead, reach, columns, j, [&](int i) {
                    if (path.distance(i * edge_ + half_, j * edge_ + half_) <= reach) visit(i, i, j);
                });
            return;
        }
        // The area within reach of a straight bead is a capsule: convex, so one interval of columns a row.
        const PlanCapsule capsule(bead, reach);
        for (int j = columns.j0; j <= columns.j1; ++j) {
            const double y = j * edge_ + half_;
            if (!capsule.meets(y)) continue;
            const int i0 = std::max(first(capsule.left(y)), columns.i0);
            const int i1 = std::min(last(capsule.right(y)), columns.i1);
            if (i0 <= i1) visit(i0, i1, j);
        }
    }

private:
    // The columns of a row that lie within `reach` of an arc's circle: the row's intersection with an annulus. Slightly
    // too wide, because the two ends of an arc may differ in radius and because of rounding; the caller tests each.
    template <typename Visit>
    void forEachNearRing(const gcode::Bead& bead, double reach, const ColumnRange& columns, int j, Visit visit) const {
        const gcode::Arc& arc = toolpath_.arcs[static_cast<std::size_t>(bead.arc)];
        const double a = std::hypot(bead.x0 - arc.center_x, bead.y0 - arc.center_y);
        const double b = std::hypot(bead.x1 - arc.center_x, bead.y1 - arc.center_y);
        const double outer = std::max(a, b) + reach + 1e-6 * edge_;
        const double inner = std::min(a, b) - reach - 1e-6 * edge_;
        const double dy = j * edge_ + half_ - arc.center_y;
        if (std::abs(dy) > outer) return;
        const double far = std::sqrt(outer * outer - dy * dy);
        const int i0 = std::max(first(arc.center_x - far), columns.i0);
        const int i1 = std::min(last(arc.center_x + far), columns.i1);
        int hole0 = i1 + 1;
        int hole1 = i1;
        if (inner > std::abs(dy)) {
            const double near = std::sqrt(inner * inner - dy * dy);
            hole0 = last(arc.center_x - near) + 1;
            hole1 = first(arc.center_x + near) - 1;
        }
        for (int i = i0; i <= std::min(i1, hole0 - 1); ++i) visit(i);
        for (int i = std::max(i0, std::max(hole0, hole1 + 1)); i <= i1; ++i) visit(i);
    }

    // A bead too steep for flats is a rod of the same area; see BeadField.
    double radiusOf(const gcode::Bead& bead, const Section& section) const {
        return bead.z0 == bead.z1 ? section.radius : BeadField(toolpath_, bead).radius();
    }
    // By truncation: std::ceil() and std::floor() are calls where the processor need not have SSE 4.1.
    int first(double mm) const {
        const double column = (mm - half_) * per_edge_ - 1e-9;
        const int truncated = static_cast<int>(column);
        return truncated + static_cast<int>(truncated < column);
    }
    int last(double mm) const {
        const double column = (mm - half_) * per_edge_ + 1e-9;
        const int truncated = static_cast<int>(column);
        return truncated - static_cast<int>(truncated > column);
    }

    const gcode::Toolpath& toolpath_;
    const double edge_, half_;  // mm
    const double per_edge_;
    const bool fills_grooves_;
    const double swell_;         // mm, by which outlines move out
    const double band_, slack_;  // mm
};

}  // namespace stratum::voxelize
