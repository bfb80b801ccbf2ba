#include "deposit/bead_support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::deposit {
namespace {

gcode::PlanPath segment(double x0, double y0, double x1, double y1) {
    return {gcode::Toolpath{}, gcode::Bead{.x0 = x0, .y0 = y0, .x1 = x1, .y1 = y1, .arc = -1}};
}

// From (radius, 0) about the origin.
gcode::PlanPath arc(double radius, double sweep) {
    gcode::Toolpath toolpath;
    toolpath.arcs.push_back({0, 0, sweep});
    return {
        toolpath,
        gcode::Bead{.x0 = radius, .y0 = 0, .x1 = radius * std::cos(sweep), .y1 = radius * std::sin(sweep), .arc = 0}};
}

void expectParts(const gcode::PlanPath& path, const gcode::PlanPath& other, double reach,
                 const std::vector<PathPart>& expected) {
    std::vector<PathPart> parts;
    partsNear(path, other, reach, parts);
    ASSERT_EQ(parts.size(), expected.size());
    for (std::size_t n = 0; n < parts.size(); ++n) {
        EXPECT_NEAR(parts[n].from, expected[n].from, 2e-6);
        EXPECT_NEAR(parts[n].to, expected[n].to, 2e-6);
    }
}

void expectBeside(const gcode::PlanPath& path, const gcode::PlanPath& other, PathPart held, double reach,
                  PathPart expected) {
    std::vector<PathPart> parts;
    partsBeside(path, other, held, reach, parts);
    ASSERT_FALSE(parts.empty());
    // The parts of two segments adjoin.
    std::sort(parts.begin(), parts.end(), [](const PathPart& a, const PathPart& b) { return a.from < b.from; });
    double to = parts[0].from;
    for (const PathPart& part : parts) {
        EXPECT_LE(part.from, to + 1e-9);
        to = std::max(to, part.to);
    }
    EXPECT_NEAR(parts[0].from, expected.from, 2e-6);
    EXPECT_NEAR(to, expected.to, 2e-6);
}

void expectNothingBeside(const gcode::PlanPath& path, const gcode::PlanPath& other, double reach) {
    std::vector<PathPart> parts;
    partsBeside(path, other, {0, other.length()}, reach, parts);
    for (const PathPart& part : parts) EXPECT_LT(part.to - part.from, 1e-9);
}

TEST(PathParts, PartsNearASegment) {
    const gcode::PlanPath path = segment(0, 0, 10, 0);
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

TEST(PathParts, PartsNearAnArc) {
    // A line through a ring is near it twice.
    expectParts(segment(-10, 0, 10, 0), arc(5, 2 * std::numbers::pi), 1, {{4, 6}, {14, 16}});
    expectParts(arc(5, std::numbers::pi), arc(5.5, std::numbers::pi), 1, {{0, 5 * std::numbers::pi}});
    expectParts(arc(5, std::numbers::pi), arc(7, std::numbers::pi), 1, {});
    const double near = 5 * std::asin(0.2);
    expectParts(arc(5, std::numbers::pi), segment(-9, 0, 9, 0), 1,
                {{0, near}, {5 * std::numbers::pi - near, 5 * std::numbers::pi}});
}

TEST(PathParts, PartsBesideASegment) {
    const gcode::PlanPath path = segment(0, 0, 10, 0);
    const double beyond_end = std::sqrt(1 - 0.9 * 0.9);
    expectBeside(path, segment(2, 0.9, 7, 0.9), {0, 5}, 1, {2 - beyond_end, 7 + beyond_end});
    expectBeside(path, segment(7, 0.9, 2, 0.9), {0, 5}, 1, {2 - beyond_end, 7 + beyond_end});
    expectBeside(path, segment(2, 0.9, 7, 0.9), {1, 4}, 1, {3, 6});
    expectBeside(path, segment(2, 0.9, 7, 0.9), {0, 4}, 1, {2 - beyond_end, 6});
    expectBeside(path, segment(2, 0.2, 7, 0.2), {0, 5}, 1, {1.8, 7.2});  // not farther ahead than aside
    expectBeside(path, segment(0, 0, 10, 0), {2, 4}, 1, {2, 4});
    expectBeside(path, segment(3, 0.5, 3, 0.5), {0, 0}, 1, {2.5, 3.5});
    expectBeside(path, segment(2, -1, 8, 1), {0, 10}, 0.5, {5 - 0.5 * std::sqrt(10), 5 + 0.5 * std::sqrt(10)});
    expectBeside(segment(4, 0.8, 4, 0.8), path, {3, 5}, 1, {0, 0});
    expectNothingBeside(path, segment(2, 1.1, 7, 1.1), 1);
    expectNothingBeside(path, segment(10, 0, 15, 0), 1);  // ahead
    expectNothingBeside(path, segment(15, 0.1, 10.2, 0.1), 1);
    expectNothingBeside(path, segment(10, 0, 10, 5), 1);  // a corner
    expectNothingBeside(path, segment(5, -4, 5, 4), 1);   // a crossing
    expectNothingBeside(path, segment(3, -4, 7, 4), 1);
    std::vector<PathPart> parts;
    partsBeside(segment(4, 0.8, 4, 0.8), path, {5, 6}, 1, parts);
    EXPECT_TRUE(parts.empty());
}

TEST(PathParts, PartsBesideAnArc) {
    const double half = std::numbers::pi;
    expectBeside(arc(5, half), arc(5.5, half), {0, 5.5 * half}, 1, {0, 5 * half});
    expectBeside(arc(5, half), arc(5.5, half), {1.1, 5.5}, 1, {1, 5});
    expectBeside(arc(5, 2 * half), segment(5.5, -9, 5.5, 9), {9, 18}, 1, {0, 5 * std::acos(0.9)});
    expectNothingBeside(arc(5, half), arc(7, half), 1);
    expectNothingBeside(arc(5, half), segment(5, 0, 5, -4), 1);     // ahead
    expectNothingBeside(segment(-9, 0, 9, 0), arc(5, half), 0.25);  // crossings
    // A small ring beside a line has both sides of it within reach.
    expectBeside(segment(-5, 1, 5, 1), arc(1, 2 * half), {0, 2 * half}, 0.25, {5 - 0.75, 5 + 0.75});
}

}  // namespace
}  // namespace stratum::deposit
