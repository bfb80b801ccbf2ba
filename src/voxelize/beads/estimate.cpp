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
        solid += length * gcode::sectionArea(static_cast<double>(bead.width), height);
        // One side of a wall is seen, the others touch neighbours.
        surface += length * height;
    }
    // Coarse voxels: all of the solid is within the band, and a band stands around it. Fine ones: two bands along it.
    return std::min(solid + surface * band, 2 * surface * band) / (voxel_size * voxel_size * voxel_size);
}

}  // namespace stratum::voxelize
