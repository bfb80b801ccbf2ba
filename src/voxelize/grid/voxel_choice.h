// Chooses voxels a layer from an error, a memory limit or the size of a pixel.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/grid/voxelizer.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace stratum::voxelize {

/// The largest distances between the level set's surface and that of the beads' union, in voxels, at two voxels a layer
/// or more, of real prints; tests check both. From the level set to the beads: in the creases between beads. From the
/// beads to the level set, at points with two voxels of empty space in front (no grid resolves narrower gaps): where
/// a thin gap is filled (of 999 in 1000 points; slits that close beside a point may be off by two voxels
/// there). Means fall from 0.06 to 0.02 voxel (docs/level_set.md).
constexpr double kLargestErrorVoxels = 0.5;
constexpr double kLargestMissVoxels = 0.75;

/// The fewest that is chosen automatically: with one voxel a layer a bead may have no sample inside.
constexpr int kFewestVoxelsPerLayer = 2;

/// The fewest voxels a layer, from kFewestVoxelsPerLayer, that keep the larger of those errors below `tolerance` (mm).
/// Throws UsageError if 64 are too few.
int voxelsPerLayerForTolerance(double layer_height, double tolerance);

/// The fewest voxels a layer, from kFewestForPixels to kMostForPixels, with a voxel no longer than half of `pixel`
/// (mm; 0: the most). The largest error is then a quarter of a pixel, unless kMostForPixels is too few;
/// docs/level_set.md has its effect on pictures.
int voxelsPerLayerForPixel(double layer_height, double pixel);
constexpr int kFewestForPixels = 2;  ///< one voxel a layer can't represent a layer's round side
constexpr int kMostForPixels = 16;
constexpr double kVoxelsPerPixel = 2;

/// Bytes of a grid, of what is made beside it (VoxelizeOptions::bytes_per_leaf) and of its construction. `keep`:
/// counted from the z extents of the beads of every leaf column, a few per cent too many. `cull`: measured by a culled
/// build at no more than two voxels a layer, scaled like a surface.
double estimateBytes(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection, const Lattice& lattice,
                     Interior interior, double bytes_per_leaf = kBytesPerLeaf);

/// The most voxels a layer (kFewestVoxelsPerLayer to 16) whose estimate is within `budget` bytes. Throws UsageError,
/// with the estimate for the fewest, if not even they fit.
int voxelsPerLayerWithin(double budget, const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                         const Lattice& any_size, Interior interior, double bytes_per_leaf = kBytesPerLeaf);

/// "4GB", "800 MB", "1.5g" -> bytes; powers of ten, or of 1024 with an i: "4GiB". Throws UsageError.
double parseSize(std::string_view text);

}  // namespace stratum::voxelize
