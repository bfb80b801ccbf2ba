// The box of a print's active voxels, found without building them.
#pragma once

#include "ondemand/print_layout.h"

#include <openvdb/openvdb.h>

namespace stratum::ondemand {

/// Index-space box of the samples within the narrow band, as openvdb::Grid::evalActiveVoxelBoundingBox() of the whole
/// grid says. Evaluates a leaf or a few for each side: where the beads that reach farthest say that it must end.
openvdb::CoordBBox findActiveBox(const PrintLayout& layout);

}  // namespace stratum::ondemand
