#include "voxelize/beads/placement.h"

#include "base/error.h"

#include <fmt/format.h>

namespace stratum::voxelize {

double millimetresIn(const std::string& unit) { return unit == "m" ? 1000.0 : unit == "cm" ? 10.0 : 1.0; }

Placement placementOf(const std::string& unit, const std::string& up, const std::string& origin, const Bounds& bounds) {
    Placement placement;
    placement.unit = 1 / millimetresIn(unit);
    placement.up_y = up == "y";
    if (origin == "bed") return placement;
    for (int axis = 0; axis < 2; ++axis)
        placement.offset[axis] = origin == "center" ? -bounds.center(axis) : -bounds.min[axis];
    placement.offset[2] = -bounds.min[2];
    return placement;
}

openvdb::math::Transform::Ptr makeTransform(const Lattice& lattice, const Placement& placement) {
    const double edge = lattice.voxel_size * placement.unit;
    // OpenVDB treats a transform whose determinant is below 3e-15 as singular.
    constexpr double kSmallestEdge = 1.45e-5;
    if (edge < kSmallestEdge)
        throw UsageError(
            fmt::format("voxels of {:g} world units are smaller than the {:g} that OpenVDB can place; choose --unit mm "
                        "or cm, or a voxel of {:g} mm or more",
                        edge, kSmallestEdge, kSmallestEdge / placement.unit));
    auto transform = openvdb::math::Transform::createLinearTransform(edge);
    transform->postTranslate(openvdb::Vec3d(placement.offset[0] * placement.unit, placement.offset[1] * placement.unit,
                                            (placement.offset[2] + lattice.origin_z) * placement.unit));
    // A quarter turn about x. Exact: a rotation by an angle would have 6e-17 in place of zeros.
    if (placement.up_y) transform->postMult(openvdb::Mat4d(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1));
    return transform;
}

}  // namespace stratum::voxelize
