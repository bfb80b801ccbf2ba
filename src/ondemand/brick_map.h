// A conservative map of a print's surface: one bit for each brick, from the beads' outlines alone.
#pragma once

#include "march/file/leaf_field.h"
#include "ondemand/print_layout.h"

#include <openvdb/openvdb.h>

#include <cstdint>
#include <vector>

namespace stratum::ondemand {

// The box of a print's active voxels, found without building them.

/// Index-space box of the samples within the narrow band: openvdb::Grid::evalActiveVoxelBoundingBox() of the whole
/// grid. Evaluates one or a few leaves for each side, at the outermost beads.
openvdb::CoordBBox findActiveBox(const PrintLayout& layout);

struct PrintMap {
    march::BrickMap bricks;
    std::vector<std::uint32_t> first_bead;  ///< by macro cell: index of the first bead near it; 2^32 - 1 if none
};

/// The bricks (see march/brick/brick_grid.h) with a sample in or near a bead's solid: a brick has surface only if one
/// of its 9^3 samples is inside. No voxel is evaluated. `active` is the box of active voxels. Parallel; the result does
/// not depend on the number of threads.
PrintMap mapBricks(const PrintLayout& layout, const openvdb::CoordBBox& active);

}  // namespace stratum::ondemand
