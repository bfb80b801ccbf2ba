#include "voxelize/beads/estimate.h"

#include <algorithm>

namespace stratum::voxelize {

double estimateActiveVoxels(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                            double voxel_size, double half_width) {
    const double band = half_width * voxel_size;
    double solid = 0;
    double surface = 0;
    for (const std::uint32_t index : selection) {
        const gcode::Bead& bead = toolpath.beads[index];
        const double height = static_cast<double>(toolpath.runOf(bead).height);
        const double length = gcode::beadLength(toolpath, bead);
        solid += gcode::laidVolume(toolpath, index);
        // One side of a wall is exposed, the others touch neighbours.
        surface += length * height;
    }
    // Coarse voxels: the whole solid is within the band, plus a band around it. Fine ones: a band on each side of the
    // surface.
    return std::min(solid + surface * band, 2 * surface * band) / (voxel_size * voxel_size * voxel_size);
}

}  // namespace stratum::voxelize
