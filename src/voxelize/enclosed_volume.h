// How much solid a level set encloses.
#pragma once

#include <openvdb/openvdb.h>

namespace stratum::voxelize {

/// Volume where the trilinear field is negative, world units cubed. Only signs and zero crossings count, for values
/// inside need not be distances: a cell of eight negative samples is solid, a mixed one counts by where four lines
/// along z cross zero in it. Half-widths of 2 voxels or more. Parallel; the same value for any number of threads.
double enclosedVolume(const openvdb::FloatGrid& grid);

}  // namespace stratum::voxelize
