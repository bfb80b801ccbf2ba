// Builds only what the outside can reach.
//
// A closed print is mostly inner surfaces: infill, channels between beads. The flood starts in the open air around the
// part and evaluates a leaf when it arrives there, so leaves that no outside point reaches never exist.
//
// Printed parts are not tight: between beads laid side by side runs a channel, 0.27 layer heights wide where the
// planned spacing is kept, and somewhere it meets the outside. So the flood takes only samples that keep a clearance
// from the surface (a gap of twice the clearance is the narrowest it passes); what lies around them, up to a depth, is
// shown whatever its width: grooves, steps, the sides of layers.
#pragma once

#include "voxelize/beads/plan_bins.h"
#include "voxelize/leaf/leaf_column.h"
#include "voxelize/leaf/leaf_places.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace stratum::voxelize {

struct ExteriorCounts {
    std::size_t positions = 0;  ///< leaf positions that `keep` would have to evaluate
    std::size_t evaluated = 0;
    std::size_t kept = 0;         ///< leaves
    std::size_t kept_voxels = 0;  ///< active ones
    int rounds = 0;
    double flood_seconds = 0;     ///< thread time: masks and queues
    double evaluate_seconds = 0;  ///< thread time: distances
};

struct ExteriorRule {
    float background = 0;  ///< world units
    float clearance = 0;   ///< world units: the flood passes where phi is at least this
    int depth = 3;         ///< voxels, 1..8: narrow places are shown this far from where the flood came
    double band = 2;       ///< voxels, 1..8: inside, what is this near to something shown stays active
};

/// Leaves with at least one active voxel, by column.
using LeavesByColumn = std::vector<std::vector<std::unique_ptr<Leaf>>>;

/// Fills `leaves`. Values that are shown are those of the
/// whole level set, and so are those inside near them; every other voxel is inside. Parallel; the result does not
/// depend on the number of threads. How many leaves will be reached nobody knows before: `progress` gets the share of
/// all positions reached so far, and 1 at the end; one thread at a time.
ExteriorCounts buildReachable(const PlanBins& bins, const ColumnSource& columns, std::uint32_t end,
                              const ExteriorRule& rule, LeavesByColumn& leaves,
                              const std::function<void(double)>& progress = {});

/// What buildReachable would keep, found in the whole grid of the same beads, which must not change meanwhile: no
/// distance is evaluated.
ExteriorCounts countReachable(const PlanBins& bins, const ColumnSource& columns, std::uint32_t end,
                              const ExteriorRule& rule, const openvdb::FloatTree& whole);

}  // namespace stratum::voxelize
