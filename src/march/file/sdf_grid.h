// Samples an analytic signed distance function as a level set.
#pragma once

#include "trace/sdf.h"

#include <openvdb/openvdb.h>

#include <cstddef>

namespace stratum::march {

/// Samples the shape on cubes of this edge (world units), in a narrow band of three voxels to each side. Leaves far
/// from the surface, by the distance at their middle, are not sampled. Parallel. Throws UsageError for infinite shapes,
/// and for a voxel size that is not positive, too coarse for the shape, or that needs more than 2^31 candidate leaves
/// or an estimate of more than `memory_limit` bytes (0: a quarter of the available memory; the text names a voxel size
/// that fits).
openvdb::FloatGrid::Ptr makeSdfGrid(const trace::Sdf& shape, double voxel_size, std::size_t memory_limit = 0);

}  // namespace stratum::march
