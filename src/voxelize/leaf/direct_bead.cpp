// LeafColumn's part for sloped and round beads: evaluated in 3-D, bead by bead.
#include "voxelize/beads/bead_field.h"
#include "voxelize/leaf/leaf_column.h"

#include <algorithm>
#include <cmath>

namespace stratum::voxelize {
namespace {

// `z` (mm): the origin of the kernel's z.
LocalRod localRod(const gcode::Bead& bead, const BeadField& field, double drop, double x, double y, double z,
                  double scale) {
    const double dx = bead.x1 - bead.x0;
    const double dy = bead.y1 - bead.y0;
    const double dz = bead.z1 - bead.z0;
    const double plan = std::sqrt(dx * dx + dy * dy);
    const double length = std::sqrt(dx * dx + dy * dy + dz * dz);
    // n: level, across the path; u: along it; b = u x n. For a vertical or empty path the direction of n is arbitrary.
    const double nx = plan > 0 ? -dy / plan : 0.0;
    const double ny = plan > 0 ? dx / plan : 1.0;
    const double ux = length > 0 ? dx / length : 1.0;
    const double uy = length > 0 ? dy / length : 0.0;
    const double uz = length > 0 ? dz / length : 0.0;
    const double bx = -uz * ny;
    const double by = uz * nx;
    const double bz = ux * ny - uy * nx;
    const double px = x - bead.x0;
    const double py = y - bead.y0;
    const double pz = z - (bead.z0 - drop);
    const double along = ux * px + uy * py + uz * pz;
    const auto world = [scale](double mm) { return static_cast<float>(mm * scale); };
    LocalRod rod{};
    rod.nx = static_cast<float>(nx);
    rod.ny = static_cast<float>(ny);
    rod.n0 = world(nx * px + ny * py);
    rod.bx = static_cast<float>(bx);
    rod.by = static_cast<float>(by);
    rod.bz = static_cast<float>(bz);
    rod.b0 = world(bx * px + by * py + bz * pz);
    rod.ux = static_cast<float>(ux);
    rod.uy = static_cast<float>(uy);
    rod.uz = static_cast<float>(uz);
    rod.lo = world(-along);
    rod.hi = world(length - along);
    rod.radius = world(field.radius());
    return rod;
}

}  // namespace

void LeafColumn::expandDirect(const DirectBead& direct, int k0, std::span<PlanField> planes) {
    const gcode::Bead& bead = toolpath_.beads[stack_.beads[direct.rank]];
    const BeadField field(toolpath_, bead);
    const double drop = sectionOf(toolpath_, bead).drop;
    // Heights are relative to the middle of the leaf.
    const double z_middle = sampleZ(k0) + 0.5 * (kLeafDim - 1) * lattice_.voxel_size;
    const auto forEachPlane = [&](auto visit) {
        for (std::size_t z = 0; z < planes.size(); ++z) {
            const double height = sampleZ(k0 + static_cast<int>(z));
            if (height < direct.z_min || height > direct.z_max) continue;
            visit(static_cast<float>((height - z_middle) * scale_), planes[z]);
        }
    };
    if (field.rod()) {
        const LocalRod rod = localRod(bead, field, drop, middle_x_, middle_y_, z_middle, scale_);
        forEachPlane([&](float z, PlanField& phi) { expandRod(grid_, rod, z, phi); });
        return;
    }
    PlanField d;
    PlanField sides2;
    PlanField center_z;
    if (field.path().straight()) {
        const double half_extent = 0.5 * (kLeafDim - 1) * lattice_.voxel_size;
        LocalLine line = localLine(bead, field.halfFlat(), middle_x_, middle_y_, half_extent, scale_);
        const double dx = bead.x1 - bead.x0;
        const double dy = bead.y1 - bead.y0;
        const double plan = std::sqrt(dx * dx + dy * dy);
        const double climb = plan > 0 ? (bead.z1 - bead.z0) / plan : 0.0;
        const double along = plan > 0 ? (dx * (middle_x_ - bead.x0) + dy * (middle_y_ - bead.y0)) / plan : 0.0;
        const double z0 = bead.z0 - drop + along * climb - z_middle;
        slopedLine(grid_, line, static_cast<float>(z0 * scale_), static_cast<float>(climb), d, center_z);
        if (field.halfSide() == 0) squaredSides(d, sides2);
    } else {
        // Helices of flat beads are rare, and the angle along one has no closed form.
        for (std::size_t c = 0; c < kColumnSamples; ++c) {
            const double x = (i_ + static_cast<int>(c / 8)) * lattice_.voxel_size;
            const double y = (j_ + static_cast<int>(c % 8)) * lattice_.voxel_size;
            const double offset = field.path().distance(x, y) - field.halfFlat();
            const double z = std::lerp(bead.z0, bead.z1, field.path().parameter(x, y)) - drop - z_middle;
            d.v[c] = static_cast<float>(offset * scale_);
            const double side = std::max(offset, 0.0) * scale_;
            sides2.v[c] = static_cast<float>(side * side);
            center_z.v[c] = static_cast<float>(z * scale_);
        }
    }
    const SlopedTerm term{static_cast<float>(field.cosine()), static_cast<float>(field.reach() * scale_),
                          static_cast<float>(field.radius() * scale_), static_cast<float>(field.halfSide() * scale_)};
    if (field.halfSide() > 0) {
        forEachPlane([&](float z, PlanField& phi) { expandSlopedSides(d, center_z, term, z, phi); });
    } else {
        forEachPlane([&](float z, PlanField& phi) { expandSloped(sides2, center_z, term, z, phi); });
    }
}

}  // namespace stratum::voxelize
