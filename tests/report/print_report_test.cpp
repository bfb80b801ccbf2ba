#include "report/print_report.h"

#include "reported_print.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>
#include <set>
#include <string>

namespace stratum::report {
namespace {

using std::numbers::pi;
using test::addArc;
using test::addBead;
using test::allBeads;
using test::layeredLattice;
using test::numberOf;
using test::reportOfAll;

// One straight bead of length L: a bar of stadium section, and two half discs of radius c swept by half circles.
struct OneBead {
    double length = 40, width = 3, height = 2;
    double r() const { return height / 2; }
    double c() const { return (width - height) / 2; }
    // By Pappus: the half disc of radius r at its centroid 4 r / (3 pi) from the flat's edge, turned about the end.
    double ends() const { return pi * c() * c() * height + pi * r() * r() / 2 * 2 * pi * (c() + 4 * r() / (3 * pi)); }
    double volume() const { return length * gcode::sectionArea(width, height) + ends(); }
};

gcode::Toolpath pathOf(const OneBead& bead) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 1, 2, bead.height, 1 + bead.length, 2, bead.height, bead.width, bead.height);
    return toolpath;
}

TEST(PrintReport, VolumeAndCentreOfOneBead) {
    const OneBead bead;
    const PrintReport report = reportOfAll(pathOf(bead), layeredLattice(bead.height, 20));
    EXPECT_NEAR(numberOf(report, "plastic_volume"), bead.volume(), 0.002 * bead.volume());
    EXPECT_NEAR(numberOf(report, "deposited_volume"), bead.length * gcode::sectionArea(3, 2), 1e-6);
    const auto& center = std::get<Vector3>(report.find("center_of_mass")->value);
    EXPECT_NEAR(center[0], 1 + bead.length / 2, 0.01);
    EXPECT_NEAR(center[1], 2, 0.01);
    EXPECT_NEAR(center[2], bead.height / 2, 0.01);
    EXPECT_NEAR(numberOf(report, "porosity"), 0, 0.5);
    EXPECT_NEAR(numberOf(report, "thinnest_wall"), bead.width, 0.01);
    // The perimeter of the section, and the ends: the discs and the half circles turned about the end (Pappus).
    const double around = 2 * (bead.width - bead.height) + pi * bead.height;
    const double ends = 2 * pi * bead.c() * bead.c() + pi * bead.r() * 2 * pi * (bead.c() + 2 * bead.r() / pi);
    EXPECT_NEAR(numberOf(report, "outer_surface"), bead.length * around + ends, 0.01 * (bead.length * around + ends));
    EXPECT_EQ(numberOf(report, "inner_surface"), 0);
}

// Of a print on a belt places and axes are those of the world.
TEST(PrintReport, OfABeadOnABelt) {
    const OneBead bead;
    gcode::Toolpath toolpath = pathOf(bead);
    const PrintReport level = reportOfAll(toolpath, layeredLattice(bead.height, 10));
    toolpath.belt_angle = 45;
    const PrintReport report = reportOfAll(toolpath, layeredLattice(bead.height, 10));
    const double half = std::sqrt(0.5);
    const auto& center = std::get<Vector3>(report.find("center_of_mass")->value);
    EXPECT_NEAR(center[1], half * (2 - bead.height / 2), 0.01);
    EXPECT_NEAR(center[2], half * (2 + bead.height / 2), 0.01);
    // About x nothing changes; the axes of y and z mix.
    const auto& flat = std::get<Matrix3>(level.find("inertia_of_volume")->value);
    const auto& leaning = std::get<Matrix3>(report.find("inertia_of_volume")->value);
    const double scale = flat[1][1];
    EXPECT_NEAR(leaning[0][0], flat[0][0], 1e-9 * scale);
    EXPECT_NEAR(leaning[1][1], (flat[1][1] + flat[2][2]) / 2 - flat[1][2], 1e-9 * scale);
    EXPECT_NEAR(leaning[1][2], (flat[1][1] - flat[2][2]) / 2, 1e-9 * scale);
    EXPECT_NEAR(leaning[1][2], leaning[2][1], 1e-9 * scale);
    EXPECT_EQ(report.find("bed_contact"), nullptr);
    EXPECT_EQ(numberOf(report, "plastic_volume"), numberOf(level, "plastic_volume"));
}

// A tube of one bead a layer: its section is turned about the axis, exactly.
struct Tube {
    double radius = 6, width = 1.2, height = 0.8;
    int layers = 8;
    double r() const { return height / 2; }
    double c() const { return (width - height) / 2; }
    // Of the section: area and the moments of rho^3 and z^2 rho, as an integral over z.
    double integral(const auto& f) const {
        constexpr int kSteps = 4000;
        double sum = 0;
        for (int n = 0; n < kSteps; ++n) {
            const double z = height * ((n + 0.5) / kSteps - 0.5);
            const double half = c() + std::sqrt(r() * r() - z * z);
            sum += f(radius - half, radius + half, z) * height / kSteps;
        }
        return sum;
    }
    double volumeOfLayer() const {
        return integral([](double a, double b, double) { return pi * (b * b - a * a); });
    }
};

TEST(PrintReport, InertiaOfATube) {
    const Tube tube;
    const gcode::Toolpath path = test::tube(tube.radius, tube.width, tube.height, tube.layers);
    ReportOptions options;
    options.density = 1.25;
    options.price = 20;
    const PrintReport report = reportOfAll(path, layeredLattice(tube.height, 16), options);
    const double layer = tube.volumeOfLayer();
    EXPECT_NEAR(numberOf(report, "plastic_volume"), tube.layers * layer, 0.002 * tube.layers * layer);
    const auto& center = std::get<Vector3>(report.find("center_of_mass")->value);
    EXPECT_NEAR(center[0], 0, 0.01);
    EXPECT_NEAR(center[1], 0, 0.01);
    EXPECT_NEAR(center[2], tube.layers * tube.height / 2, 0.01);
    // About the axis: the integral of rho^2; across it: half of that and z^2, layer by layer (Steiner).
    const double turn =
        tube.integral([](double a, double b, double) { return pi / 2 * (std::pow(b, 4) - std::pow(a, 4)); });
    double across = 0;
    for (int n = 0; n < tube.layers; ++n) {
        const double z = (n + 0.5) * tube.height - tube.layers * tube.height / 2;
        across += turn / 2 + layer * z * z +
                  tube.integral([](double a, double b, double t) { return pi * (b * b - a * a) * t * t; });
    }
    const auto& inertia = std::get<Matrix3>(report.find("inertia_of_volume")->value);
    EXPECT_NEAR(inertia[2][2], tube.layers * turn, 0.005 * tube.layers * turn);
    EXPECT_NEAR(inertia[0][0], across, 0.005 * across);
    EXPECT_NEAR(inertia[1][1], across, 0.005 * across);
    for (const auto& [a, b] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}})
        EXPECT_NEAR(inertia[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)], 0, 0.001 * across);
    // Mass, cost and the tensor with density.
    const double mass = 1.25e-3 * numberOf(report, "deposited_volume");
    EXPECT_NEAR(numberOf(report, "mass"), mass, 1e-9);
    EXPECT_NEAR(numberOf(report, "cost"), mass * 1e-3 * 20, 1e-9);
    const auto& heavy = std::get<Matrix3>(report.find("inertia")->value);
    // Of the mass that was fed, spread evenly in the measured solid.
    EXPECT_NEAR(heavy[2][2], 1.25e-3 * inertia[2][2], 1e-3 * heavy[2][2]);
    // Open above and below: no pores but what the grooves are deeper than three voxels.
    EXPECT_LT(numberOf(report, "porosity"), 0.5);
    EXPECT_NEAR(numberOf(report, "thinnest_wall"), tube.width, 0.01);
}

TEST(PrintReport, VolumeAtFewVoxelsALayer) {
    const Tube tube;
    const Tube usual{5, 0.45, 0.2, 12};
    for (const auto& [one, voxels] : {std::pair{tube, 4}, {tube, 6}, {tube, 8}, {usual, 4}, {usual, 8}}) {
        const PrintReport report =
            reportOfAll(test::tube(one.radius, one.width, one.height, one.layers), layeredLattice(one.height, voxels));
        const double expected = one.layers * one.volumeOfLayer();
        EXPECT_NEAR(numberOf(report, "plastic_volume"), expected, 0.002 * expected) << voxels;
    }
}

// Of a wall of a few voxels the level set holds less than the plastic, which is within what encloses it.
TEST(PrintReport, EnclosedIsNoLessThanPlastic) {
    const PrintReport report = reportOfAll(test::tube(5, 0.4, 0.2, 12), layeredLattice(0.2, 2));
    EXPECT_GE(numberOf(report, "enclosed_volume"), numberOf(report, "plastic_volume"));
    EXPECT_EQ(numberOf(report, "porosity"), 0);
}

TEST(PrintReport, TurnedScaledAndMovedGridsSayTheSame) {
    const gcode::Toolpath path = test::tube(3, 0.6, 0.4, 4);
    const auto beads = allBeads(path);
    const voxelize::Lattice lattice = layeredLattice(0.4, 4);
    const auto plain = reportOf(*voxelize::voxelize(path, beads, lattice), path, beads, lattice, std::nullopt, {});
    voxelize::VoxelizeOptions options;
    options.placement = {0.001, {5, 6, 7}, true};
    const auto placed = voxelize::voxelize(path, beads, lattice, options);
    auto other = reportOf(*placed, path, beads, lattice, std::nullopt, {});
    for (const char* key : {"plastic_volume", "enclosed_volume", "outer_surface", "thinnest_wall", "roughness_ra"}) {
        const double a = plain.at("numbers").at(key).at("value");
        const double b = other.at("numbers").at(key).at("value");
        EXPECT_NEAR(a, b, 1e-5 * std::abs(a)) << key;
    }
}

TEST(PrintReport, SameBytesForAnyNumberOfThreads) {
    gcode::Toolpath path = test::tube(4, 0.6, 0.4, 6);
    for (int layer = 1; layer <= 6; ++layer)
        for (int n = -2; n <= 2; ++n)
            addBead(path, -3, n, layer * 0.4, 3, n, layer * 0.4, 0.6, 0.4, static_cast<std::uint32_t>(layer));
    const auto beads = allBeads(path);
    const voxelize::Lattice lattice = layeredLattice(0.4, 4);
    const auto grid = voxelize::voxelize(path, beads, lattice);
    std::string one;
    {
        const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 1);
        one = reportOf(*grid, path, beads, lattice, std::nullopt, {}).dump();
    }
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 7);
    for (int n = 0; n < 3; ++n) EXPECT_EQ(reportOf(*grid, path, beads, lattice, std::nullopt, {}).dump(), one);
}

TEST(PrintReport, SaysWhatItCantTell) {
    const gcode::Toolpath path = test::tube(3, 0.6, 0.4, 4);
    const auto beads = allBeads(path);
    const voxelize::Lattice lattice = layeredLattice(0.4, 4);
    voxelize::VoxelizeOptions build;
    build.interior = voxelize::Interior::cull;
    ReportOptions options;
    options.culled = true;
    const auto json =
        reportOf(*voxelize::voxelize(path, beads, lattice, build), path, beads, lattice, std::nullopt, options);
    EXPECT_FALSE(json["numbers"].contains("porosity"));
    EXPECT_FALSE(json["numbers"].contains("mass"));
    EXPECT_TRUE(json["numbers"].contains("enclosed_volume"));
    std::set<std::string> left;
    for (const auto& one : json["left_out"]) {
        left.insert(one["number"]);
        EXPECT_FALSE(one["why"].get<std::string>().empty());
        EXPECT_FALSE(one["remedy"].get<std::string>().empty());
    }
    for (const char* key : {"porosity", "mass", "cost", "time", "thinnest_wall", "center_of_mass", "plastic_volume"})
        EXPECT_TRUE(left.contains(key)) << key;
}

TEST(PrintReport, EveryNumberIsThereOrLeftOut) {
    const PrintReport report = reportOfAll(test::tube(3, 0.6, 0.4, 4), layeredLattice(0.4, 4));
    for (const Definition& definition : numberDefinitions()) {
        const bool left = std::any_of(report.left_out.begin(), report.left_out.end(),
                                      [&](const LeftOut& one) { return one.definition == &definition; });
        EXPECT_NE(report.find(definition.key) != nullptr, left) << definition.key;
    }
    for (const Column& column : report.by_layer) EXPECT_EQ(column.values.size(), report.layers.size());
    for (const Column& column : report.by_slab) EXPECT_EQ(column.values.size(), report.slabs.size());
}

// A spiral has no layers to rest on each other, and no line of its wall begins on a bed.
TEST(PrintReport, OfASpiral) {
    gcode::Toolpath path;
    for (int turn = 0; turn < 8; ++turn)
        addArc(path, 0, 0, 5, 0, 2 * pi, 0.4 * (turn + 1), 0.4 * (turn + 2), 0.6, 0.4,
               static_cast<std::uint32_t>(turn + 1));
    const PrintReport report = reportOfAll(path, layeredLattice(0.4, 4));
    EXPECT_EQ(report.find("bonding_least"), nullptr);
    EXPECT_FALSE(report.slabs_are_layers);
    EXPECT_GT(numberOf(report, "plastic_volume"), 0);
    EXPECT_NEAR(numberOf(report, "thinnest_wall"), 0.6, 0.02);
}

}  // namespace
}  // namespace stratum::report
