#include "voxelize/beads/part_bounds.h"

#include <algorithm>
#include <iterator>
#include <vector>

namespace stratum::voxelize {

Bounds partBounds(const gcode::Toolpath& toolpath, std::span<const gcode::Purpose> purposes,
                  std::span<const std::uint32_t> selection, double tilt) {
    const std::vector<std::uint32_t> part = gcode::beadsUpTo(gcode::Purpose::support, purposes, selection);
    Bounds bounds = boundsOf(toolpath, part, tilt);
    std::vector<std::uint32_t> brim;
    std::copy_if(selection.begin(), selection.end(), std::back_inserter(brim),
                 [&](std::uint32_t bead) { return purposes[bead] == gcode::Purpose::brim; });
    // All are taken where nothing but a brim and what is beside the part is selected.
    if (brim.empty() || part.size() == selection.size()) return bounds;
    const Bounds around = boundsOf(toolpath, brim, tilt);
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
