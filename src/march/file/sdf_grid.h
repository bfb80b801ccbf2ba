// Shape by formula -> level set.
#pragma once

#include "trace/sdf.h"

#include <openvdb/openvdb.h>

#include <cstddef>

namespace stratum::march {

/// Samples the shape on cubes of this edge (world units), in a narrow band of three voxels to each side. Leaves that
/// the distance at their middle shows to be away from the surface are never sampled. Parallel. Throws UsageError for
/// shapes without an end, and for a voxel size that is not positive, leaves nothing of the shape, or needs more than
/// 2^31 leaves to look at, or by an estimate more than `memory_limit` bytes (0: what is
/// available; the text names a voxel size that fits).
openvdb::FloatGrid::Ptr makeSdfGrid(const trace::Sdf& shape, double voxel_size, std::size_t memory_limit = 0);

}  // namespace stratum::march
