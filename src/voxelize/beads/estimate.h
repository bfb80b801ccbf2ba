// Estimates of voxels and memory for a voxel size, from the beads alone.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <cstdint>
#include <span>

namespace stratum::voxelize {

/// Bytes of a grid for each active voxel, inactive voxels of leaves included: 5.4 to 6.0 on real prints.
constexpr double kBytesPerActiveVoxel = 5.5;

/// Bytes of a leaf: its values, mask and header, and its share of the nodes above.
constexpr double kBytesPerLeaf = 2048 + 64 + 64 + 32;

/// Estimated number of active voxels, from lengths and section areas; overlaps are ignored. Within a few per cent on
/// dense prints at two to six voxels a layer (58 M for 56.8 M), within a factor of two or three elsewhere.
/// `voxel_size` in mm, `half_width` in voxels.
double estimateActiveVoxels(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                            double voxel_size, double half_width);

}  // namespace stratum::voxelize
