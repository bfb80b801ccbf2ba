// The box of a print's active voxels, found without building them.
#pragma once

#include "ondemand/print_layout.h"

#include <openvdb/openvdb.h>

namespace stratum::ondemand {

/// Index-space box of the samples within the narrow band: openvdb::Grid::evalActiveVoxelBoundingBox() of the whole
/// grid. Evaluates one or a few leaves for each side, at the outermost beads.
openvdb::CoordBBox findActiveBox(const PrintLayout& layout);

}  // namespace stratum::ondemand
