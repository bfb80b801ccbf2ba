// The reference intersector: OpenVDB's own LevelSetRayIntersector behind trace::Intersector.
#pragma once

#include "trace/intersector.h"

#include <openvdb/openvdb.h>

#include <memory>

namespace stratum::march {

/// Traces with openvdb::tools::LevelSetRayIntersector (Museth 2014, HDDA) and returns the geometric normal of the
/// trilinear field in the hit's cell. Keeps a reference to the grid. Throws InputError for grids that
/// requireTraceable() refuses.
std::unique_ptr<trace::Intersector> makeVdbIntersector(openvdb::FloatGrid::ConstPtr grid);

}  // namespace stratum::march
