// How much solid a level set encloses.
#pragma once

#include <openvdb/openvdb.h>

#include <cstddef>
#include <limits>

namespace stratum::voxelize {

/// Volume where the trilinear field is negative, world units cubed. Only signs and zero crossings count, for values
/// inside need not be distances: a cell of eight negative samples is solid, a mixed one counts by where four lines
/// along z cross zero in it. Half-widths of 2 voxels or more. Of grids with more leaves than `most_leaves`, about that
/// many, picked by a hash of their number, stand for all. Parallel; the same value for any number of threads.
double enclosedVolume(const openvdb::FloatGrid& grid,
                      std::size_t most_leaves = std::numeric_limits<std::size_t>::max());

/// Leaves that give the volume of a print to about one per cent, in less than 0.1 s.
constexpr std::size_t kVolumeSample = 8192;

}  // namespace stratum::voxelize
