#include "voxelize/beads/part_bounds.h"

#include <algorithm>
#include <vector>

namespace stratum::voxelize {

Bounds partBounds(const gcode::Toolpath& toolpath, std::span<const gcode::Purpose> purposes,
                  std::span<const std::uint32_t> selection) {
    std::vector<std::uint32_t> part;
    std::vector<std::uint32_t> brim;
    for (const std::uint32_t bead : selection) {
        if (purposes[bead] == gcode::Purpose::brim)
            brim.push_back(bead);
        else if (purposes[bead] != gcode::Purpose::beside)
            part.push_back(bead);
    }
    if (part.empty()) return boundsOf(toolpath, selection);
    Bounds bounds = boundsOf(toolpath, part);
    if (brim.empty()) return bounds;
    const Bounds around = boundsOf(toolpath, brim);
    for (int axis = 0; axis < 2; ++axis) {
        bounds.min[axis] = std::min(bounds.min[axis], std::max(around.min[axis], bounds.min[axis] - kBrimReach));
        bounds.max[axis] = std::max(bounds.max[axis], std::min(around.max[axis], bounds.max[axis] + kBrimReach));
    }
    bounds.min[2] = std::min(bounds.min[2], around.min[2]);
    return bounds;
}

Bounds placed(const Bounds& bounds, const Placement& placement) {
    Bounds world;
    for (int axis = 0; axis < 3; ++axis) {
        world.min[axis] = (bounds.min[axis] + placement.offset[axis]) * placement.unit;
        world.max[axis] = (bounds.max[axis] + placement.offset[axis]) * placement.unit;
    }
    if (!placement.up_y) return world;
    Bounds turned;
    turned.include({{world.min[0], world.min[2], -world.max[1]}, {world.max[0], world.max[2], -world.min[1]}});
    return turned;
}

}  // namespace stratum::voxelize
