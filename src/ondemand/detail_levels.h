// Voxel sizes by distance from the eye, from the size of a pixel there.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace stratum::ondemand {

/// The size of a pixel by distance from the eye; made from shade::PixelSpread.
struct PixelGrowth {
    double per_distance = 0;  ///< least size of a pixel over distance, mm / mm
    double farthest = 0;      ///< mm from the eye to the far end of the print
};

struct VoxelLevel {
    int voxels_per_layer = 0;
    double from = 0;  ///< mm from the eye, where the level begins; it ends where the next one begins
};

/// The levels from `finest` voxels a layer, at the eye, outwards. Each further level has half as many voxels a layer,
/// and begins where one of its voxels is no longer than half a pixel, if that is before the far end. No level is finer
/// than `finest`, so several levels never cost more than that one alone for the same view. One level if no part of the
/// print is far enough for a coarser one.
/// @param layer_height  mm
/// @param smallest      mm, the size of a pixel where the print is nearest
std::vector<VoxelLevel> chooseLevels(double layer_height, int finest, double smallest, const PixelGrowth& pixels);

/// The beads of `selection` whose solid may be nearer to `eye` than `distance` (mm), in their order.
std::vector<std::uint32_t> beadsWithin(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                                       const glm::dvec3& eye, double distance);

}  // namespace stratum::ondemand
