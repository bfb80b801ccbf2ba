// Volume of the solid that a level set encloses.
#pragma once

#include <openvdb/openvdb.h>

#include <cstddef>
#include <limits>

namespace stratum::voxelize {

/// Volume where the trilinear field is negative, world units cubed. Only signs and zero crossings are used, because
/// values inside need not be distances: a cell of eight negative samples is solid; the share of a mixed one is found
/// from the zero crossings of four lines along z. Half-widths of 2 voxels or more. In grids with more leaves than
/// `most_leaves`, a sample of about that many, chosen by a hash of their number, is used. Parallel; the same value for
/// any number of threads.
double enclosedVolume(const openvdb::FloatGrid& grid,
                      std::size_t most_leaves = std::numeric_limits<std::size_t>::max());

/// Leaves that give the volume of a print to about one per cent, in less than 0.1 s.
constexpr std::size_t kVolumeSample = 8192;

}  // namespace stratum::voxelize
