// The exact intersector: bricks, traversed by integer steps, and the nearest root of each cell's cubic.
#pragma once

#include "march/brick/brick_layout.h"
#include "march/file/leaf_field.h"
#include "march/file/leaf_file.h"
#include "trace/intersector.h"

#include <openvdb/openvdb.h>

#include <cstddef>
#include <limits>
#include <memory>

namespace stratum::march {

/// Lays the level set out in bricks (see brick_grid.h) and traces them. Hits are the exact zeros of the trilinear field
/// of the grid's samples, as they are or rounded to 16 bits: nothing is missed and nothing leaks between cells. The
/// grid is not needed afterwards. Throws InputError for grids that requireTraceable() refuses. Tracers keep no state.
std::unique_ptr<trace::Intersector> makeBrickIntersector(const openvdb::FloatGrid& grid,
                                                         BrickValues values = BrickValues::Int16);
/// The same of a file: bricks of large level sets are lazy, i.e. laid out when rays first reach them. The hits are the
/// same. Their samples take at most `cache_bytes` at a time: bricks not read recently are evicted. Throws UsageError if
/// that is too little (see BrickGrid).
std::unique_ptr<trace::Intersector> makeBrickIntersector(
    std::shared_ptr<const LeafFile> file, BrickValues values = BrickValues::Int16,
    std::size_t cache_bytes = std::numeric_limits<std::size_t>::max());
/// The same of a level set whose samples are computed on demand. The hits are those of its grid.
std::unique_ptr<trace::Intersector> makeBrickIntersector(
    std::shared_ptr<const LeafField> field, BrickValues values = BrickValues::Int16,
    std::size_t cache_bytes = std::numeric_limits<std::size_t>::max());

class BrickGrid;
/// An intersector together with the bricks that it traces, to count the bricks that rays reached and to update them
/// after their field has changed. Both share one owner: either keeps the other alive.
struct TracedBricks {
    std::shared_ptr<const trace::Intersector> intersector;
    std::shared_ptr<BrickGrid> bricks;
};
/// makeBrickIntersector() of a field, for callers that need its bricks, too.
TracedBricks makeTracedBricks(std::shared_ptr<const LeafField> field, BrickValues values = BrickValues::Int16,
                              std::size_t cache_bytes = std::numeric_limits<std::size_t>::max());

}  // namespace stratum::march
