// Lattices, bands, transforms and walls at the edge of what a grid can hold.
#include "base/error.h"
#include "march/brick/brick_intersector.h"
#include "march/file/level_set_file.h"
#include "study/geometry/field_error.h"
#include "study/geometry/handmade.h"
#include "study/stability/stability_case.h"
#include "voxelize/grid/interior_distance.h"

#include <fmt/format.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <cmath>
#include <limits>

namespace stratum::study {
namespace {

constexpr const char* kGridError = "largest error of the distance, mm";

StabilityCase field(std::string name, const voxelize::Lattice& lattice, const voxelize::VoxelizeOptions& options = {}) {
    const gcode::Toolpath toolpath = crossedLines(kBeadWidth, kBeadHeight);
    return {"grid",     std::move(name),
            kGridError, fieldTolerance(toolpath, lattice),
            kRoundings, [=] { return largestFieldError(toolpath, lattice, options); }};
}

// 0 if `work` is refused by an error of this kind, 1 if it is not.
template <typename Error>
StabilityCase refusal(std::string name, const std::function<void()>& work) {
    return {
        "grid", std::move(name), "accepted (1) or refused with a message (0)", 0, "what can't be is refused", [work] {
            openvdb::initialize();
            try {
                work();
            } catch (const Error&) {
                return 0.0;
            }
            return 1.0;
        }};
}

// Two upright walls with `gap` voxels between them, and what a ray across them meets: the walls' sides where the
// gap is at least two voxels. Largest distance of a met side from its place, mm.
double sidesOfAGap(double gap) {
    openvdb::initialize();
    constexpr double kVoxel = 0.05;
    gcode::Toolpath toolpath;
    const double shift = 0.5 * (kBeadWidth + gap * kVoxel);
    for (int layer = 1; layer <= 5; ++layer)
        for (const double side : {-1.0, 1.0})
            addBead(toolpath, -2, side * shift, kBeadHeight * layer, 2, side * shift, kBeadHeight * layer, kBeadWidth,
                    kBeadHeight, static_cast<std::uint32_t>(layer));
    const auto grid = voxelize::voxelize(toolpath, allBeads(toolpath), plainLattice(kVoxel, kBeadHeight));
    const auto intersector = march::makeBrickIntersector(*grid);
    const auto tracer = intersector->makeTracer();
    double largest = 0;
    for (int n = -20; n <= 20; ++n)
        for (const double side : {-1.0, 1.0}) {
            trace::Hit hit;
            // From the middle of the gap towards a wall, at the height of a bead's widest place.
            const trace::Ray ray{{n * 0.0713, 0, 2.5 * kBeadHeight}, {0, side, 0}};
            if (!tracer->intersect(ray, hit)) return std::numeric_limits<double>::infinity();
            largest = std::max(largest, std::abs(hit.t - 0.5 * gap * kVoxel));
        }
    return largest;
}

// A wall of `thickness` voxels, somewhere between the lattice's planes: the share of rays across that meet nothing.
double raysThroughAWall(double thickness) {
    openvdb::initialize();
    constexpr double kVoxel = 0.1;
    const double width = thickness * kVoxel;
    gcode::Toolpath toolpath;
    addBead(toolpath, -2, 0.031, 1, 2, 0.047, 1, width, 1);
    const auto intersector =
        march::makeBrickIntersector(*voxelize::voxelize(toolpath, allBeads(toolpath), plainLattice(kVoxel, 1)));
    const auto tracer = intersector->makeTracer();
    int missed = 0;
    constexpr int kRays = 400;
    for (int n = 0; n < kRays; ++n) missed += tracer->occluded({{-1.9 + 3.8 * n / kRays, -5, 0.5}, {0, 1, 0}}) ? 0 : 1;
    return static_cast<double>(missed) / kRays;
}

// At the voxels of `a` that are active and positive, mm.
double largestDifferenceOutside(const openvdb::FloatGrid& a, const openvdb::FloatGrid& b) {
    const auto accessor = b.getConstAccessor();
    double largest = 0;
    for (auto voxel = a.cbeginValueOn(); voxel; ++voxel)
        if (*voxel > 0)
            largest = std::max(largest, std::abs(static_cast<double>(*voxel) -
                                                 static_cast<double>(accessor.getValue(voxel.getCoord()))));
    return largest;
}

// Culled against kept: what of the outside differs, mm.
double cullingChanges() {
    openvdb::initialize();
    gcode::Toolpath toolpath;
    for (int layer = 1; layer <= 10; ++layer)
        for (const double side : {-1.0, 1.0}) {
            const double z = kBeadHeight * layer;
            const auto number = static_cast<std::uint32_t>(layer);
            addBead(toolpath, -2, side * 2, z, 2, side * 2, z, kBeadWidth, kBeadHeight, number);
            addBead(toolpath, side * 2, -2, z, side * 2, 2, z, kBeadWidth, kBeadHeight, number);
        }
    const auto beads = allBeads(toolpath);
    voxelize::VoxelizeOptions options;
    const auto kept = voxelize::voxelize(toolpath, beads, plainLattice(0.05, kBeadHeight), options);
    options.interior = voxelize::Interior::cull;
    const auto culled = voxelize::voxelize(toolpath, beads, plainLattice(0.05, kBeadHeight), options);
    return largestDifferenceOutside(*culled, *kept);
}

// A series of partial prints ends with the bytes of the whole.
double seriesEndsAsTheWhole() {
    openvdb::initialize();
    const gcode::Toolpath toolpath = crossedLines(kBeadWidth, kBeadHeight);
    const auto beads = allBeads(toolpath);
    const voxelize::Lattice lattice = plainLattice(0.05, kBeadHeight);
    voxelize::Voxelizer voxelizer(toolpath, beads, lattice);
    for (std::uint32_t end = 1; end <= toolpath.beads.size(); ++end) voxelizer.printUntil(end);
    return largestDifference(*voxelizer.printAll(), *voxelize::voxelize(toolpath, beads, lattice));
}

// The sweep replaces what is inside only. Largest change outside, mm.
double sweepChangesOutside() {
    openvdb::initialize();
    const gcode::Toolpath toolpath = crossedLines(kBeadWidth, kBeadHeight);
    const auto before = voxelize::voxelize(toolpath, allBeads(toolpath), plainLattice(0.05, kBeadHeight));
    const auto after = before->deepCopy();
    voxelize::sweepInterior(*after);
    return largestDifferenceOutside(*before, *after);
}

void addLattices(std::vector<StabilityCase>& cases) {
    for (const double count : {0.6, 0.9, 1.0, 1.7, 16.0, 64.0})
        cases.push_back(
            field(fmt::format("{:g} voxels a layer", count), plainLattice(kBeadHeight / count, kBeadHeight)));
    for (const double half_width : {1.0, 1.5, 7.3, 10.0})
        cases.push_back(
            field(fmt::format("half-width of {:g} voxels", half_width), plainLattice(0.04, kBeadHeight, half_width)));
    voxelize::Lattice shifted = plainLattice(0.05, kBeadHeight);
    shifted.origin_z = 0.025;
    cases.push_back(field("lattice half a voxel off the layers", shifted));
    shifted.origin_z = 1e-9;
    cases.push_back(field("lattice a picometre off the layers", shifted));
}

void addTransforms(std::vector<StabilityCase>& cases) {
    voxelize::VoxelizeOptions options;
    options.placement.unit = 0.001;
    cases.push_back(field("in metres", plainLattice(0.05, kBeadHeight), options));
    cases.push_back(refusal<UsageError>("in metres, voxels of 0.01 mm", [options] {
        gcode::Toolpath toolpath;
        addBead(toolpath, 0, 0, kBeadHeight, 1, 0, kBeadHeight, kBeadWidth, kBeadHeight);
        voxelize::voxelize(toolpath, allBeads(toolpath), plainLattice(0.01, kBeadHeight), options);
    }));
    options.placement.unit = 1e6;
    cases.push_back(field("in nanometres", plainLattice(0.05, kBeadHeight), options));
    options.placement = {1, {1e6, -1e6, 1e6}, false};
    cases.push_back(field("moved by a kilometre", plainLattice(0.05, kBeadHeight), options));
    options.placement = {0.1, {3, -2, 1}, true};
    cases.push_back(field("y up, in centimetres, moved", plainLattice(0.05, kBeadHeight), options));
    cases.push_back(refusal<InputError>("voxels that are sheared", [] {
        const auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(1, openvdb::Vec3f(0), 0.1F);
        grid->transform().preShear(0.2, openvdb::math::X_AXIS, openvdb::math::Y_AXIS);
        march::makeBrickIntersector(*grid);
    }));
    cases.push_back(refusal<InputError>("a sample that is no number", [] {
        const auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(1, openvdb::Vec3f(0), 0.1F);
        grid->beginValueOn().setValue(std::numeric_limits<float>::quiet_NaN());
        march::makeBrickIntersector(*grid);
    }));
    cases.push_back(refusal<UsageError>("more voxels than memory", [] {
        gcode::Toolpath toolpath;
        addBead(toolpath, 0, 0, kBeadHeight, 1000, 1000, kBeadHeight, kBeadWidth, kBeadHeight);
        voxelize::voxelize(toolpath, allBeads(toolpath), plainLattice(1e-4, kBeadHeight));
    }));
}

void addWalls(std::vector<StabilityCase>& cases) {
    for (const double gap : {2.0, 3.5})
        cases.push_back({"grid", fmt::format("gap of {:g} voxels between walls", gap),
                         "distance of a wall from its place, mm", 0.5 * 0.05,
                         "half a voxel, the bound that --tolerance works with", [gap] { return sidesOfAGap(gap); }});
    for (const double thickness : {2.0, 1.1})
        cases.push_back({"grid", fmt::format("wall of {:g} voxels", thickness), "share of rays that pass through", 0,
                         "thicker than a voxel: a whole row of samples lies within it",
                         [thickness] { return raysThroughAWall(thickness); }});
    cases.push_back({"grid", "culled or kept", "largest change outside, mm", 0, "culling evaluates the same kernels",
                     cullingChanges});
    cases.push_back({"grid", "bead by bead or at once", "largest difference, mm", 0,
                     "the result does not depend on the steps before", seriesEndsAsTheWhole});
    cases.push_back({"grid", "distances inside", "largest change outside, mm", 0, "only negative values are swept",
                     sweepChangesOutside});
}

}  // namespace

std::vector<StabilityCase> gridCases() {
    std::vector<StabilityCase> cases;
    addLattices(cases);
    addTransforms(cases);
    addWalls(cases);
    return cases;
}

}  // namespace stratum::study
