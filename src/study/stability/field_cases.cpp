// Moves that nobody slices and everybody gets one day, and lattices at the edge of what a grid can hold. More of both
// are in tests/voxelize/grid/extremes_test.cpp.
#include "march/brick/brick_intersector.h"
#include "study/geometry/field_error.h"
#include "study/geometry/handmade.h"
#include "study/stability/stability_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace stratum::study {
namespace {

constexpr double kBeadWidth = 0.45, kBeadHeight = 0.2;  // mm, in cases that don't depend on it

// How far the grid is from the exact field, in double, of the same beads.
StabilityCase field(std::string name, const gcode::Toolpath& toolpath,
                    const voxelize::Lattice& lattice = plainLattice(0.05, kBeadHeight),
                    const voxelize::VoxelizeOptions& options = {}) {
    return {"field",
            std::move(name),
            "largest error of the distance, mm",
            fieldTolerance(toolpath, lattice),
            "8 float roundings of the longest local length (leaf, band or half width)",
            [=] { return largestFieldError(toolpath, lattice, options); }};
}

gcode::Toolpath one(double x1, double y1, double z1, double width = kBeadWidth) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, kBeadHeight, x1, y1, z1, width, kBeadHeight);
    return toolpath;
}

// Two beads from (x0, y0) to (x1, y1), the second one back or mirrored in y.
gcode::Toolpath two(double x0, double x1, double y, bool back) {
    gcode::Toolpath toolpath;
    addBead(toolpath, x0, y, kBeadHeight, x1, -y, kBeadHeight, kBeadWidth, kBeadHeight);
    if (back) std::swap(x0, x1);
    addBead(toolpath, x0, -y, kBeadHeight, x1, y, kBeadHeight, kBeadWidth, kBeadHeight);
    return toolpath;
}

// About a centre that keeps the path near the origin.
gcode::Toolpath arc(double radius, double from, double sweep) {
    gcode::Toolpath toolpath;
    addArc(toolpath, -radius * std::cos(from), -radius * std::sin(from), radius, from, sweep, kBeadHeight, kBeadHeight,
           kBeadWidth, kBeadHeight);
    return toolpath;
}

// Three turns of chords that climb by so many layers a turn.
gcode::Toolpath spiral(double layers) {
    gcode::Toolpath toolpath;
    constexpr int kChords = 40;
    const auto x = [](int n) { return 2 * std::cos(n * 2 * std::numbers::pi / kChords); };
    const auto y = [](int n) { return 2 * std::sin(n * 2 * std::numbers::pi / kChords); };
    const auto z = [layers](int n) { return kBeadHeight * (1 + layers * n / kChords); };
    for (int n = 0; n < 3 * kChords; ++n)
        addBead(toolpath, x(n), y(n), z(n), x(n + 1), y(n + 1), z(n + 1), kBeadWidth, kBeadHeight);
    return toolpath;
}

// Of what is on the plane between two layers whose planes miss each other by `gap` (mm), the most positive, mm.
double crackBetweenLayers(double gap) {
    openvdb::initialize();
    gcode::Toolpath toolpath;
    addBead(toolpath, -2, 0, kBeadHeight, 2, 0, kBeadHeight, kBeadWidth, kBeadHeight, 1);
    addBead(toolpath, -2, 0, 2 * kBeadHeight + gap, 2, 0, 2 * kBeadHeight + gap, kBeadWidth, kBeadHeight, 2);
    const auto grid = voxelize::voxelize(toolpath, allBeads(toolpath), plainLattice(0.05, kBeadHeight));
    const auto accessor = grid->getConstAccessor();
    double largest = -1;
    for (int i = -30; i <= 30; ++i)
        largest = std::max(largest, static_cast<double>(accessor.getValue(openvdb::Coord(i, 0, 4))));
    return largest;
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

}  // namespace

std::vector<StabilityCase> fieldCases() {
    constexpr double kTurn = 2 * std::numbers::pi;
    const gcode::Toolpath crossed = crossedLines(kBeadWidth, kBeadHeight);
    voxelize::Lattice shifted = plainLattice(0.05, kBeadHeight);
    shifted.origin_z = 0.025;
    voxelize::Lattice hardly_shifted = shifted;
    hardly_shifted.origin_z = 1e-9;
    const auto placed = [&](std::string name, const voxelize::Placement& placement) {
        voxelize::VoxelizeOptions options;
        options.placement = placement;
        return field(std::move(name), crossed, plainLattice(0.05, kBeadHeight), options);
    };
    std::vector<StabilityCase> cases{
        field("move of a picometre", one(1e-12, 0, kBeadHeight)),
        field("forth and back on one line", two(0, 3, 0, true)),
        field("crossing at a microradian", two(-2, 2, 2e-6, false)),
        field("10 m from the origin", crossedLines(kBeadWidth, kBeadHeight, 1e4, -1e4, 100)),
        field("width 0", one(2, 1, kBeadHeight, 0)),
        field("width of a thousandth of the height", one(2, 1, kBeadHeight, 1e-3 * kBeadHeight),
              plainLattice(0.02, kBeadHeight)),
        field("full circle", arc(2, 0.3, kTurn)),
        field("circle of 1 \u00b5m", arc(1e-3, 0.3, kTurn)),
        field("circle narrower than its bead", arc(0.1, 0.3, -kTurn)),
        field("arc of 100 m radius, 2 mm long", arc(1e5, 0.7, 2e-5)),
        field("arc that turns a nanoradian", arc(2, 0.7, 1e-9)),
        field("spiral of one layer a turn", spiral(1)),
        field("spiral of ten layers a turn", spiral(10)),
        field("straight up", one(0, 0, 3)),
        field("slope of a microradian", one(4, 0.3, kBeadHeight + 4e-6)),
        field("lattice half a voxel off the layers", crossed, shifted),
        field("lattice a picometre off the layers", crossed, hardly_shifted),
        placed("in metres", {0.001, {}, false}),
        placed("in nanometres", {1e6, {}, false}),
        placed("moved by a kilometre", {1, {1e6, -1e6, 1e6}, false}),
        placed("y up, in centimetres, moved", {0.1, {3, -2, 1}, true})};
    for (const double gap : {1e-9, 1e-4, 2e-3})
        cases.push_back({"field", fmt::format("layers that miss each other by {:g} mm", gap),
                         "largest value on the plane between, mm", 0,
                         "gaps of up to 2 % of a layer are welded: inside is not positive",
                         [gap] { return crackBetweenLayers(gap); }});
    for (const double gap : {2.0, 3.5})
        cases.push_back({"field", fmt::format("gap of {:g} voxels between walls", gap),
                         "distance of a wall from its place, mm", 0.5 * 0.05,
                         "half a voxel, the bound that --tolerance works with", [gap] { return sidesOfAGap(gap); }});
    for (const double thickness : {2.0, 1.1})
        cases.push_back({"field", fmt::format("wall of {:g} voxels", thickness), "share of rays that pass through", 0,
                         "thicker than a voxel: a whole row of samples lies within it",
                         [thickness] { return raysThroughAWall(thickness); }});
    return cases;
}

}  // namespace stratum::study
