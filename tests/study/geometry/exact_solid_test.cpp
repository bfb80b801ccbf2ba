#include "study/geometry/exact_solid.h"

#include "../voxelize/toolpaths.h"
#include "base/error.h"
#include "corpus.h"
#include "study/geometry/field_error.h"
#include "study/geometry/handmade.h"
#include "study/print.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <cmath>
#include <numbers>
#include <random>
#include <utility>

namespace stratum::study {
namespace {

constexpr double kPi = std::numbers::pi;

// Three layers of five lines at the spacing of the slicers.
gcode::Toolpath plate(double spacing) {
    gcode::Toolpath toolpath;
    for (int layer = 1; layer <= 3; ++layer)
        for (int line = 0; line < 5; ++line)
            addBead(toolpath, 0, line * spacing, 0.2 * layer, 6, line * spacing, 0.2 * layer, 0.45, 0.2,
                    static_cast<std::uint32_t>(layer));
    return toolpath;
}
const double kSlicersSpacing = gcode::sectionArea(0.45, 0.2) / 0.2;

TEST(ExactSolid, IsTheBruteForceOverAllBeads) {
    const gcode::Toolpath toolpath = readPrint((test::dataDir() / "gcode" / "tile.gcode").string());
    std::vector<std::uint32_t> beads;
    for (const std::uint32_t index : voxelize::selectBeads(toolpath, {})) beads.push_back(index);
    gcode::Toolpath selected = toolpath;
    selected.beads.clear();
    for (const std::uint32_t index : beads) selected.beads.push_back(toolpath.beads[index]);
    const ExactSolid field(toolpath, beads, 0.3);
    const test::BruteForce brute(selected);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(0, 1);
    int near = 0;
    for (int n = 0; n < 20000; ++n) {
        glm::dvec3 p;
        for (int axis = 0; axis < 3; ++axis)
            p[axis] = field.bounds().min[axis] + unit(random) * field.bounds().extent(axis);
        const double expected = brute(p.x, p.y, p.z);
        const double found = field.distance(p);
        if (expected > 0)
            ASSERT_NEAR(found, std::min(expected, 0.3), 1e-9);
        else
            ASSERT_LE(found, 1e-9);
        near += std::abs(expected) < 0.1 ? 1 : 0;
    }
    EXPECT_GT(near, 1000);
}

TEST(ExactSolid, KeepsTheVolumeOfLinesSideBySide) {
    gcode::Toolpath toolpath = plate(kSlicersSpacing);
    toolpath.deposit.beads = gcode::DepositModel::Beads::settled;
    const auto beads = allBeads(toolpath);
    const ExactSolid solid(toolpath, beads, 0.3);
    // In the middle of the plate there is no gap: the layer is a slab.
    for (double y = 0.05; y < 4 * kSlicersSpacing; y += 0.013)
        for (double z = 0.01; z < 0.6; z += 0.017) EXPECT_LT(solid.distance({3, y, z}), 1e-9) << y << " " << z;
    const double area = solid.volume(1 << 16).value;
    // Five lines of 6 mm in three layers, and their round ends.
    const double lines = 15 * 6 * gcode::sectionArea(0.45, 0.2);
    EXPECT_GT(area, lines);
    EXPECT_LT(area, lines * 1.09);
}

// Layers 2 to 4, whose tops are open where the hull narrows.
gcode::Toolpath openTops(double crown, double corner_fraction) {
    gcode::Toolpath toolpath = readPrint((test::dataDir() / "gcode" / "hull.gcode").string());
    toolpath.deposit.beads = gcode::DepositModel::Beads::settled;
    toolpath.deposit.crown = crown;
    toolpath.deposit.corner_fraction = corner_fraction;
    return toolpath;
}

TEST(ExactSolid, IsWhatTheVoxelizerMakes) {
    openvdb::initialize();
    for (const auto& [crown, corner_fraction] : {std::pair{0.0, 1.0}, std::pair{0.2, 1.0}, std::pair{0.3, 0.6}}) {
        const gcode::Toolpath toolpath = openTops(crown, corner_fraction);
        voxelize::Selection selection;
        voxelize::parseLayers("2:4", selection);
        std::vector<std::uint32_t> beads;
        for (const std::uint32_t bead : voxelize::selectBeads(toolpath, selection))
            if (toolpath.beads[bead].z0 == toolpath.beads[bead].z1) beads.push_back(bead);
        const ExactSolid solid(toolpath, beads, 0.3);
        const voxelize::Lattice lattice = latticeOf(toolpath, beads, 4);
        const auto grid = voxelize::voxelize(toolpath, beads, lattice);
        std::size_t seen = 0;
        std::size_t above = 0;  // the plane of the flats
        std::size_t number = 0;
        for (auto voxel = grid->cbeginValueOn(); voxel; ++voxel) {
            if (number++ % 499 != 0) continue;
            const openvdb::Vec3d at = grid->indexToWorld(voxel.getCoord());
            const glm::dvec3 p(at[0], at[1], at[2]);
            const double expected = solid.distance(p);
            if (expected <= 1e-6 || expected > 0.1) continue;
            ++seen;
            above += p.z > 0.8 ? 1 : 0;
            EXPECT_NEAR(static_cast<double>(*voxel), expected, 2e-5) << crown;
            constexpr double kStep = 1e-5;  // mm
            glm::dvec3 slope;
            for (int axis = 0; axis < 3; ++axis) {
                glm::dvec3 step(0);
                step[axis] = kStep;
                slope[axis] = (solid.distance(p + step) - solid.distance(p - step)) / (2 * kStep);
            }
            EXPECT_LT(glm::length(slope), solid.slope()) << crown;
        }
        EXPECT_GT(seen, 400U);
        EXPECT_GT(above, 100U);
    }
}

// As many by area everywhere: a single bead's flats, sides and ends have theirs.
TEST(ExactSolid, PointsAreEvenOverTheSurface) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 0.2, 6, 0, 0.2, 0.6, 0.2);
    const auto beads = allBeads(toolpath);
    const ExactSolid solid(toolpath, beads, 0.3);
    const auto points = solid.samplePoints(20000);
    ASSERT_EQ(points.size(), 20000U);
    double on_top = 0;
    for (const auto& [position, normal] : points) {
        EXPECT_NEAR(solid.distance(position), 0, 1e-9);
        EXPECT_NEAR(glm::length(normal), 1, 1e-9);
        EXPECT_GT(solid.distance(position + 1e-3 * normal), 0);
        on_top += normal.z > 0.9999 ? 1 : 0;
    }
    // The flat is 6 x 0.4 and a disc of 0.2; all of it is that twice, the sides, and half a torus.
    const double pi = std::acos(-1.0);
    const double flat = 6 * 0.4 + pi * 0.2 * 0.2;
    const double round = 2 * pi * 0.1 * 6 + 2 * pi * pi * 0.2 * 0.1 + 4 * pi * 0.1 * 0.1;
    EXPECT_NEAR(on_top / 20000, flat / (2 * flat + round), 0.015);
    const auto again = solid.samplePoints(500);
    for (std::size_t n = 0; n < again.size(); ++n) EXPECT_EQ(again[n].position, points[n].position);
}

TEST(ExactSolid, ArcsAreSpreadByAreaToo) {
    gcode::Toolpath toolpath;
    addArc(toolpath, 0, 0, 1, 0.4, 2, 0.2, 0.2, 0.6, 0.2);
    const ExactSolid field(toolpath, allBeads(toolpath), 0.3);
    const auto points = field.samplePoints(100000);
    std::size_t inner = 0;
    std::size_t outer = 0;
    for (const auto& p : points) {
        ASSERT_NEAR(field.distance(p.position), 0, 1e-7);
        ASSERT_NEAR(field.distance(p.position + 1e-3 * p.normal), 1e-3, 1e-6);
        const double angle = std::atan2(p.position.y, p.position.x);
        if (angle < 0.5 || angle > 2.3) continue;
        const double radius = std::hypot(p.position.x, p.position.y);
        inner += radius < 0.8 ? 1 : 0;
        outer += radius > 1.2 ? 1 : 0;
    }
    // Pappus: half circles of radius r, their middles at 2 r / pi from the flats' edges.
    const double expected = (1.2 + 0.2 / kPi) / (0.8 - 0.2 / kPi);
    EXPECT_NEAR(static_cast<double>(outer) / static_cast<double>(inner), expected, 0.06);
}

TEST(ExactSolid, TakesNoPointsFromWhatIsWeldedOrCovered) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 0.2, 3, 0, 0.2, 0.6, 0.2, 1);
    addBead(toolpath, 0, 0.1, 0.2, 3, 0.1, 0.2, 0.6, 0.2, 1);
    addBead(toolpath, 0, 0, 0.4, 3, 0, 0.4, 0.6, 0.2, 2);
    const ExactSolid field(toolpath, allBeads(toolpath), 0.3);
    std::size_t bottom = 0;
    std::size_t strip = 0;
    for (const auto& p : field.samplePoints(60000)) {
        const bool plane = std::abs(p.position.z - 0.2) < 1e-6;
        // What of the plane between the layers is not under the upper bead's flat.
        EXPECT_FALSE(plane && std::abs(p.position.y) < 0.19 && p.position.x > 0 && p.position.x < 3);
        if (std::abs(p.position.z) < 1e-6 && p.position.x > 0 && p.position.x < 3) {
            ++bottom;
            strip += p.position.y > 0 && p.position.y < 0.1 ? 1 : 0;  // under both of the lower beads
        }
    }
    EXPECT_NEAR(static_cast<double>(strip) / static_cast<double>(bottom), 0.1 / 0.5, 0.02);
}

TEST(ExactSolid, CountsVolume) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 0.2, 3, 0, 0.2, 0.2, 0.2);  // a capsule
    const ExactSolid field(toolpath, allBeads(toolpath), 0.3);
    const ExactSolid::Volume volume = field.volume(1 << 16);
    const double exact = kPi * 0.01 * 3 + 4.0 / 3 * kPi * 0.001;
    EXPECT_NEAR(volume.value, exact, 5 * volume.error);
    EXPECT_LT(volume.error, 0.002 * exact);
}

TEST(ExactSolid, RefusesToBeOfNothing) {
    const gcode::Toolpath toolpath;
    EXPECT_THROW(ExactSolid(toolpath, allBeads(toolpath), 0.3), UsageError);
}

// Two beads side by side, 0.05 apart at their widest: that is the least that points between them see.
TEST(ExactSolid, TellsHowMuchSpaceIsInFront) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 0.2, 4, 0, 0.2, 0.6, 0.2);
    addBead(toolpath, 0, 0.65, 0.2, 4, 0.65, 0.2, 0.6, 0.2);
    const ExactSolid field(toolpath, allBeads(toolpath), 0.3);
    EXPECT_NEAR(field.clearance({{2, 0.3, 0.1}, {0, 1, 0}}, 1), 0.05, 1e-4);
    EXPECT_EQ(field.clearance({{2, -0.3, 0.1}, {0, -1, 0}}, 1), 1);
    EXPECT_EQ(field.clearance({{2, 0.1, 0.2}, {0, 0, 1}}, 1), 1);
    // At 30 degrees up the other side is farther away, and met where the mirror image of the point is not.
    const double up = std::sin(0.5);
    const double out = std::cos(0.5);
    const double seen = field.clearance({{2, 0.2 + 0.1 * out, 0.1 + 0.1 * up}, {0, out, up}}, 1);
    EXPECT_GT(seen, 0.05);
    for (const auto& point : field.samplePoints(2000)) EXPECT_GT(field.clearance(point, 1), 0.049);
}

}  // namespace
}  // namespace stratum::study
