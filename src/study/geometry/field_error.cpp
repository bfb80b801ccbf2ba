#include "study/geometry/field_error.h"

#include "study/geometry/handmade.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/placement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace stratum::study {

double largestFieldError(const gcode::Toolpath& toolpath, const voxelize::Lattice& lattice,
                         const voxelize::VoxelizeOptions& options, std::size_t most_voxels) {
    openvdb::initialize();
    const auto beads = allBeads(toolpath);
    const auto grid = voxelize::voxelize(toolpath, beads, lattice, options);
    std::vector<voxelize::BeadField> fields;
    for (const gcode::Bead& bead : toolpath.beads) fields.emplace_back(toolpath, bead);
    const voxelize::Placement& placement = options.placement;
    const double background = lattice.background();
    const std::size_t all = std::size_t{grid->tree().leafCount()} * 512;
    if (all == 0) return std::numeric_limits<double>::quiet_NaN();
    // Odd, so that all places in a leaf have their turn.
    const std::size_t stride = all / most_voxels | 1U;
    double largest = 0;
    std::size_t number = 0;
    for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf)
        for (openvdb::Index v = 0; v < 512; ++v) {
            if (number++ % stride != 0) continue;
            const openvdb::Coord at = leaf->offsetToGlobalCoord(v);
            // Sample places as Lattice defines them, not through the grid's transform: that is under test, too.
            std::array<double, 3> p{at.x() * lattice.voxel_size, at.y() * lattice.voxel_size,
                                    at.z() * lattice.voxel_size + lattice.origin_z};
            if (placement.up_y || placement.tilt != 0) {
                const openvdb::Vec3d world = grid->indexToWorld(at);
                p = voxelize::printOf({world[0], world[1], world[2]}, placement);
            }
            double exact = background;
            for (const voxelize::BeadField& field : fields) exact = std::min(exact, field.distance(p[0], p[1], p[2]));
            const double value = static_cast<double>(leaf->getValue(v)) / placement.unit;
            const double error =
                exact > 0 ? std::abs(std::clamp(value, -background, background) - exact) : std::max(value, 0.0);
            if (!std::isfinite(value)) return std::numeric_limits<double>::quiet_NaN();
            largest = std::max(largest, error);
        }
    return largest;
}

double fieldTolerance(const gcode::Toolpath& toolpath, const voxelize::Lattice& lattice) {
    double size = std::max(lattice.background(), 8 * lattice.voxel_size);
    for (const gcode::Bead& bead : toolpath.beads) size = std::max(size, static_cast<double>(bead.width) / 2);
    return 8 * 0x1p-24 * size;
}

voxelize::Lattice plainLattice(double voxel_size, double layer_height, double half_width) {
    voxelize::Lattice lattice;
    lattice.voxel_size = voxel_size;
    lattice.layer_height = layer_height;
    lattice.half_width = half_width;
    return lattice;
}

}  // namespace stratum::study
