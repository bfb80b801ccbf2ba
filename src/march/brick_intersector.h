// The exact intersector: bricks, traversed by integer steps, and the nearest root of each cell's cubic.
#pragma once

#include "march/intersector.h"

#include <openvdb/openvdb.h>

#include <memory>

namespace stratum::march {

/// Lays the level set out in bricks (see brick_grid.h) and traces them. Hits are the exact zeros of the trilinear field
/// of the grid's float samples: nothing is missed and nothing leaks between cells. The grid is not needed afterwards.
/// Throws InputError for grids that requireTraceable() refuses. Tracers keep no state.
std::unique_ptr<Intersector> makeBrickIntersector(const openvdb::FloatGrid& grid);

}  // namespace stratum::march
