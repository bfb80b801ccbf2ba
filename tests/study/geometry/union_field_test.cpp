#include "study/geometry/union_field.h"

#include "../voxelize/toolpaths.h"
#include "base/error.h"
#include "corpus.h"
#include "study/print.h"
#include "voxelize/beads/selection.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <numbers>
#include <random>

namespace stratum::study {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(UnionField, IsTheBruteForceOverAllBeads) {
    const gcode::Toolpath toolpath = readPrint((test::dataDir() / "gcode" / "tile.gcode").string());
    std::vector<std::uint32_t> beads;
    for (const std::uint32_t index : voxelize::selectBeads(toolpath, {})) beads.push_back(index);
    gcode::Toolpath selected = toolpath;
    selected.beads.clear();
    for (const std::uint32_t index : beads) selected.beads.push_back(toolpath.beads[index]);
    const UnionField field(toolpath, beads, 0.3);
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

// Every point is on the surface, faces outwards, and parts of known area get their share.
TEST(UnionField, SpreadsPointsByArea) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 0.2, 3, 0, 0.2, 0.6, 0.2);
    const UnionField field(toolpath, allBeads(toolpath), 0.3);
    const auto points = field.samplePoints(100000);
    const double c = 0.2;
    const double r = 0.1;
    const double flats = 2 * (3 * 2 * c + kPi * c * c);
    const double all = flats + 3 * 2 * kPi * r + 2 * kPi * kPi * c * r + 4 * kPi * r * r;
    std::size_t on_flats = 0;
    for (const auto& p : points) {
        ASSERT_NEAR(field.distance(p.position), 0, 1e-7);  // run.height is a float
        ASSERT_NEAR(field.distance(p.position + 1e-3 * p.normal), 1e-3, 1e-6);
        on_flats += std::abs(p.normal.z) > 1 - 1e-12 ? 1 : 0;
    }
    EXPECT_NEAR(static_cast<double>(on_flats) / 1e5, flats / all, 5 * 0.5 / std::sqrt(1e5));
}

TEST(UnionField, ArcsAreSpreadByAreaToo) {
    gcode::Toolpath toolpath;
    addArc(toolpath, 0, 0, 1, 0.4, 2, 0.2, 0.2, 0.6, 0.2);
    const UnionField field(toolpath, allBeads(toolpath), 0.3);
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

TEST(UnionField, TakesNoPointsFromWhatIsWeldedOrCovered) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 0.2, 3, 0, 0.2, 0.6, 0.2, 1);
    addBead(toolpath, 0, 0.1, 0.2, 3, 0.1, 0.2, 0.6, 0.2, 1);
    addBead(toolpath, 0, 0, 0.4, 3, 0, 0.4, 0.6, 0.2, 2);
    const UnionField field(toolpath, allBeads(toolpath), 0.3);
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

TEST(UnionField, CountsVolume) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 0.2, 3, 0, 0.2, 0.2, 0.2);  // a capsule
    const UnionField field(toolpath, allBeads(toolpath), 0.3);
    const UnionField::Volume volume = field.volume(1 << 16);
    const double exact = kPi * 0.01 * 3 + 4.0 / 3 * kPi * 0.001;
    EXPECT_NEAR(volume.value, exact, 5 * volume.error);
    EXPECT_LT(volume.error, 0.002 * exact);
}

TEST(UnionField, RefusesWhatHasNoLevelBead) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 0.2, 3, 0, 1.2, 0.45, 0.2);
    EXPECT_THROW(UnionField(toolpath, allBeads(toolpath), 0.3).samplePoints(1), UsageError);
}

// Two beads side by side, 0.05 apart at their widest: that is the least that points between them see.
TEST(UnionField, TellsHowMuchSpaceIsInFront) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 0.2, 4, 0, 0.2, 0.6, 0.2);
    addBead(toolpath, 0, 0.65, 0.2, 4, 0.65, 0.2, 0.6, 0.2);
    const UnionField field(toolpath, allBeads(toolpath), 0.3);
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
