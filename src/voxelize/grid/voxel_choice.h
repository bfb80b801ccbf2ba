// How many voxels a layer an error or a memory limit allows.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/grid/voxelizer.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace stratum::voxelize {

/// The largest distances between the level set's surface and that of the beads' union, in voxels, at two voxels a layer
/// or more, of real prints; tests hold both. From the level set to the beads: in the creases between beads. From the
/// beads to the level set, of places with two voxels of empty space in front, for what is narrower no grid holds: where
/// a thin spot of air is filled (of 999 in 1000 points; slits that close beside a point may be off by two voxels
/// there). Means fall from 0.06 to 0.02 voxel (docs/level_set.md).
constexpr double kLargestErrorVoxels = 0.5;
constexpr double kLargestMissVoxels = 0.75;

/// The fewest that tools choose by themselves: with one voxel a layer no sample is surely inside of a bead.
constexpr int kFewestVoxelsPerLayer = 2;

/// The fewest voxels a layer, from kFewestVoxelsPerLayer, that keep the larger of those errors below `tolerance` (mm).
/// Throws UsageError if 64 are too few.
int voxelsPerLayerForTolerance(double layer_height, double tolerance);

/// The fewest voxels a layer, from kFewestForPixels to kMostForPixels, of which one is no longer than half of `pixel`
/// (mm; 0: the most). The largest error is a quarter of a pixel then, where the most are enough; see docs/level_set.md
/// for what that makes of pictures.
int voxelsPerLayerForPixel(double layer_height, double pixel);
constexpr int kFewestForPixels = 2;  ///< one can't tell a layer's round side from a flat one
constexpr int kMostForPixels = 16;
constexpr double kVoxelsPerPixel = 2;

/// Bytes of a grid and of what it takes to build it. `keep`: counted from the z extents of the beads of every leaf
/// column, a few per cent too many. `cull`: a culled build at no more than two voxels a layer, scaled
/// like a surface.
double estimateBytes(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection, const Lattice& lattice,
                     Interior interior);

/// The most voxels a layer (kFewestVoxelsPerLayer to 16) whose estimate is within `budget` bytes. Throws UsageError,
/// with what the fewest would take, if not even they fit.
int voxelsPerLayerWithin(double budget, const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                         const Lattice& any_size, Interior interior);

/// "4GB", "800 MB", "1.5g" -> bytes; powers of ten, or of 1024 with an i: "4GiB". Throws UsageError.
double parseSize(std::string_view text);

}  // namespace stratum::voxelize
