// How many voxels a layer an error or a memory limit allows.
#pragma once

#include "gcode/toolpath.h"
#include "voxelize/voxelizer.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace stratum::voxelize {

/// The largest distance between the level set's surface and the beads' union, in voxels. Measured on real prints from 1
/// to 8 voxels a layer: 0.25 to 0.50 on aligned lattices, 0.38 to 0.47 on one shifted by half a voxel; it is found in
/// the creases between beads, while the mean falls from 0.18 to 0.02 (docs/level_set.md).
constexpr double kLargestErrorVoxels = 0.5;

/// The fewest voxels a layer that keep that error below `tolerance` (mm). Throws UsageError if 64 are too few.
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

/// The most voxels a layer (at most 16) whose estimate is within `budget` bytes. Throws UsageError, with what one voxel
/// a layer would take, if not even that fits.
int voxelsPerLayerWithin(double budget, const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                         const Lattice& one_per_layer, Interior interior);

/// "4GB", "800 MB", "1.5g" -> bytes; powers of ten, or of 1024 with an i: "4GiB". Throws UsageError.
double parseSize(std::string_view text);

}  // namespace stratum::voxelize
