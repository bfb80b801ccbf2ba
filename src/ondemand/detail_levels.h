// Voxel sizes by distance from the eye, for pictures whose pixels span more of some places than of others.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace stratum::ondemand {

/// What a pixel spans, by distance from the eye; see shade::PixelSpread, which it is made of.
struct PixelGrowth {
    double per_distance = 0;  ///< mm that it spans at least, a mm of distance
    double farthest = 0;      ///< mm from the eye to the far end of the print
};

struct VoxelLevel {
    int voxels_per_layer = 0;
    double from = 0;  ///< mm from the eye, as far as the next level's
};

/// The levels from `finest` voxels a layer, at the eye, outwards: then each power of two that is coarser by half, from
/// where on one of its voxels is no longer than half of what a pixel spans there, if that begins before the far end. No
/// level is finer than `finest`, so that several never cost more than that one alone for what they show. One level if
/// there is no distance in the print at which a pixel spans twice of what `finest` is for.
/// @param layer_height  mm
/// @param smallest      mm that a pixel spans where the print is nearest
std::vector<VoxelLevel> chooseLevels(double layer_height, int finest, double smallest, const PixelGrowth& pixels);

/// Those of `selection` whose solid may come nearer to `eye` than `distance` (mm), in their order.
std::vector<std::uint32_t> beadsWithin(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                                       const glm::dvec3& eye, double distance);

}  // namespace stratum::ondemand
