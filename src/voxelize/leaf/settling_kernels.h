// Settling in SIMD: the beads of a layer over a column in pairs, and the level to which they fill their groove. See
// settling.h for the rule, leaf_kernels.h for what a column is and why all instruction sets give the same bytes.
#pragma once

#include "voxelize/beads/local_path.h"
#include "voxelize/beads/settling.h"
#include "voxelize/leaf/leaf_kernels.h"

#include <cstdint>
#include <span>

namespace stratum::voxelize {

/// One bead over a column: d = rho - half_flat, and the direction away from its path.
struct alignas(64) BeadPlan {
    PlanField d, nx, ny;
    float least = 0;  ///< of max(d, 0)
};

void planOfLine(const ColumnGrid& grid, const LocalLine& line, BeadPlan& out);
void planOfTaper(const ColumnGrid& grid, const LocalTaper& taper, BeadPlan& out);
void planOfArc(const ColumnGrid& grid, const LocalArc& arc, BeadPlan& out);

/// d = min(d, d of each).
void minimumOfPlans(std::span<const BeadPlan> plans, PlanField& d);

/// The constants of a layer, world units.
struct GrooveRule {
    const float* table;  ///< SettlingCurve::table()
    float radius;
    float closing, per_open;  ///< in radii: q = (m - closing) per_open
    float weld_level;         ///< world units

    GrooveRule(const SettlingCurve& curve, double radius);
};

/// False if the line's bead is too far from all samples of a column to fill a groove there. `half_extent` as of
/// localLine(), in world units.
bool mayFill(const LocalLine& line, const GrooveRule& rule, double half_extent);

/// Above every level.
constexpr float kNoGroove = 1e30F;

/// The lowest level of the grooves between each two of those beads of `plans`, kNoGroove where they have none. `d`: the
/// minimum over all beads.
void levelsBetween(std::span<const BeadPlan> plans, std::span<const std::uint32_t> which, const PlanField& d,
                   const GrooveRule& rule, PlanField& levels);

/// sides2 = max(min(d, levels), 0)^2; returns the least of it. Afterwards d is min(d, levels), less where the groove is
/// so shallow that the layers above and below count as touching: negative there, so that they are welded.
float fillGrooves(const PlanField& levels, const GrooveRule& rule, PlanField& d, PlanField& sides2);

/// Outlines move out by `out`: d = d - out, sides2 = max(sqrt(sides2) - out, 0)^2; returns the least of it.
float moveOut(const PlanField& out, PlanField& d, PlanField& sides2);

}  // namespace stratum::voxelize
