#include "ondemand/detail_levels.h"

#include "voxelize/beads/bead_field.h"
#include "voxelize/grid/voxel_choice.h"

#include <algorithm>

namespace stratum::ondemand {
namespace {

// A smaller gain is not worth another set of bins.
constexpr double kCoarserBy = 1.5;
constexpr double kLeastVariation = 2;

}  // namespace

std::vector<VoxelLevel> chooseLevels(double layer_height, int finest, double smallest, const PixelGrowth& pixels) {
    std::vector<VoxelLevel> levels{{finest, 0}};
    if (!(pixels.per_distance > 0) || pixels.farthest * pixels.per_distance < kLeastVariation * smallest) return levels;
    for (int count = voxelize::kMostForPixels; count >= voxelize::kFewestForPixels; count /= 2) {
        if (finest < kCoarserBy * count) continue;
        const double from = voxelize::kVoxelsPerPixel * layer_height / count / pixels.per_distance;
        if (from < pixels.farthest) levels.push_back({count, from});
    }
    return levels;
}

std::vector<std::uint32_t> beadsWithin(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                                       const glm::dvec3& eye, double distance) {
    std::vector<std::uint32_t> result;
    for (const std::uint32_t bead : selection) {
        const voxelize::Bounds box = voxelize::BeadField(toolpath, toolpath.beads[bead]).bounds();
        double square = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const double off = eye[axis] - std::clamp(eye[axis], box.min[axis], box.max[axis]);
            square += off * off;
        }
        if (square <= distance * distance) result.push_back(bead);
    }
    return result;
}

}  // namespace stratum::ondemand
