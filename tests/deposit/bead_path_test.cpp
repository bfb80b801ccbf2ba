#include "deposit/bead_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace stratum::deposit {
namespace {

BeadPath segment(double x0, double y0, double x1, double y1) {
    return {gcode::Toolpath{}, gcode::Bead{.x0 = x0, .y0 = y0, .x1 = x1, .y1 = y1, .arc = -1}};
}

// From (radius, 0) about the origin.
BeadPath arc(double radius, double sweep) {
    gcode::Toolpath toolpath;
    toolpath.arcs.push_back({0, 0, sweep});
    return {
        toolpath,
        gcode::Bead{.x0 = radius, .y0 = 0, .x1 = radius * std::cos(sweep), .y1 = radius * std::sin(sweep), .arc = 0}};
}

void expectParts(const BeadPath& path, const BeadPath& other, double reach, const std::vector<PathPart>& expected) {
    std::vector<PathPart> parts;
    path.partsNear(other, reach, parts);
    ASSERT_EQ(parts.size(), expected.size());
    for (std::size_t n = 0; n < parts.size(); ++n) {
        EXPECT_NEAR(parts[n].from, expected[n].from, 2e-6);
        EXPECT_NEAR(parts[n].to, expected[n].to, 2e-6);
    }
}

TEST(BeadPath, PlacesAndDistances) {
    EXPECT_EQ(segment(1, 1, 4, 5).length(), 5);
    EXPECT_NEAR(segment(1, 1, 4, 5).at(2.5).y, 3, 1e-12);
    EXPECT_NEAR(segment(0, 0, 4, 0).distance(7, 4), 5, 1e-12);
    EXPECT_NEAR(segment(2, 2, 2, 2).distance(5, 6), 5, 1e-12);
    const BeadPath clockwise = arc(2, -std::numbers::pi / 2);
    EXPECT_NEAR(clockwise.length(), std::numbers::pi, 1e-12);
    EXPECT_NEAR(clockwise.at(clockwise.length()).y, -2, 1e-12);
    EXPECT_NEAR(clockwise.distance(3, -3), std::hypot(3, 3) - 2, 1e-12);
    EXPECT_NEAR(clockwise.distance(0, 2), std::hypot(2, 2), 1e-12);
    EXPECT_NEAR(arc(2, 2 * std::numbers::pi).distance(0, -0.5), 1.5, 1e-12);
    EXPECT_EQ(arc(0, 1).length(), 0);
    EXPECT_TRUE(arc(0, 1).straight());
}

TEST(BeadPath, PartsNearASegment) {
    const BeadPath path = segment(0, 0, 10, 0);
    expectParts(path, segment(3, -5, 3, 5), 1, {{2, 4}});
    expectParts(path, segment(3, 1, 6, 1), 1, {{3, 6}});  // touches along all of it
    expectParts(path, segment(3, 0, 6, 0), 1, {{2, 7}});
    expectParts(path, segment(-3, 0.5, 13, 0.5), 1, {{0, 10}});
    expectParts(path, segment(3, 1.1, 6, 1.1), 1, {});
    expectParts(path, segment(5, 0.6, 5, 9), 1, {{4.2, 5.8}});
    expectParts(path, segment(5, 0, 5, 0), 1, {{4, 6}});
    expectParts(segment(5, 0.5, 5, 0.5), path, 1, {{0, 0}});
    expectParts(segment(5, 1.5, 5, 1.5), path, 1, {});
    expectParts(path, path, 1, {{0, 10}});
}

TEST(BeadPath, PartsNearAnArc) {
    // A line through a ring is near it twice.
    expectParts(segment(-10, 0, 10, 0), arc(5, 2 * std::numbers::pi), 1, {{4, 6}, {14, 16}});
    expectParts(arc(5, std::numbers::pi), arc(5.5, std::numbers::pi), 1, {{0, 5 * std::numbers::pi}});
    expectParts(arc(5, std::numbers::pi), arc(7, std::numbers::pi), 1, {});
    const double near = 5 * std::asin(0.2);
    expectParts(arc(5, std::numbers::pi), segment(-9, 0, 9, 0), 1,
                {{0, near}, {5 * std::numbers::pi - near, 5 * std::numbers::pi}});
}

}  // namespace
}  // namespace stratum::deposit
