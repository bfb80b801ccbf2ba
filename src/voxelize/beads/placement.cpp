#include "voxelize/beads/placement.h"

#include "base/error.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace stratum::voxelize {

namespace {

struct Turn {
    explicit Turn(double degrees)
        : cosine(std::cos(degrees * std::numbers::pi / 180)), sine(std::sin(degrees * std::numbers::pi / 180)) {}
    double cosine, sine;
};

}  // namespace

Placement placementOf(const gcode::Toolpath& toolpath) {
    Placement placement;
    placement.tilt = toolpath.belt_angle;
    return placement;
}

std::array<double, 3> worldOf(const std::array<double, 3>& place, const Placement& placement) {
    std::array<double, 3> world = place;
    if (placement.tilt != 0) {
        const Turn turn(placement.tilt);
        world = {place[0], turn.cosine * place[1] - turn.sine * place[2],
                 turn.sine * place[1] + turn.cosine * place[2]};
    }
    for (std::size_t axis = 0; axis < 3; ++axis) world[axis] = (world[axis] + placement.offset[axis]) * placement.unit;
    if (placement.up_y) world = {world[0], world[2], -world[1]};
    return world;
}

std::array<double, 3> printOf(const std::array<double, 3>& world, const Placement& placement) {
    std::array<double, 3> place = world;
    if (placement.up_y) place = {world[0], -world[2], world[1]};
    for (std::size_t axis = 0; axis < 3; ++axis) place[axis] = place[axis] / placement.unit - placement.offset[axis];
    if (placement.tilt == 0) return place;
    const Turn turn(placement.tilt);
    return {place[0], turn.cosine * place[1] + turn.sine * place[2], turn.cosine * place[2] - turn.sine * place[1]};
}

double millimetresIn(const std::string& unit) { return unit == "m" ? 1000.0 : unit == "cm" ? 10.0 : 1.0; }

Placement placementOf(const std::string& unit, const std::string& up, const std::string& origin, const Bounds& bounds,
                      double tilt) {
    Placement placement;
    placement.unit = 1 / millimetresIn(unit);
    placement.up_y = up == "y";
    placement.tilt = tilt;
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
    openvdb::Vec3d shift(placement.offset[0] * placement.unit, placement.offset[1] * placement.unit,
                         (placement.offset[2] + lattice.origin_z) * placement.unit);
    if (placement.tilt != 0) {
        const Turn turn(placement.tilt);
        transform->postTranslate(openvdb::Vec3d(0, 0, lattice.origin_z * placement.unit));
        openvdb::Mat4d matrix = openvdb::Mat4d::identity();  // acts on rows
        matrix(1, 1) = matrix(2, 2) = turn.cosine;
        matrix(1, 2) = turn.sine;
        matrix(2, 1) = -turn.sine;
        transform->postMult(matrix);
        shift[2] = placement.offset[2] * placement.unit;
    }
    transform->postTranslate(shift);
    // A quarter turn about x. Exact: a rotation by an angle would have 6e-17 in place of zeros.
    if (placement.up_y) transform->postMult(openvdb::Mat4d(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1));
    return transform;
}

}  // namespace stratum::voxelize
