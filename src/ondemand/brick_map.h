// Where a print may have surface: a bit a brick, from the beads' outlines alone.
#pragma once

#include "march/file/leaf_field.h"
#include "ondemand/print_layout.h"

#include <openvdb/openvdb.h>

#include <cstdint>
#include <vector>

namespace stratum::ondemand {

struct PrintMap {
    march::BrickMap bricks;
    std::vector<std::uint32_t> first_bead;  ///< by macro cell: index of the first bead that comes near; or 2^32 - 1
};

/// The bricks (see march/brick/brick_grid.h) whose 9^3 samples a bead's solid comes near: a brick has surface only if
/// one of its samples is inside. No voxel is evaluated. `active` is the box of active voxels. Parallel; the result does
/// not depend on the number of threads.
PrintMap mapBricks(const PrintLayout& layout, const openvdb::CoordBBox& active);

}  // namespace stratum::ondemand
