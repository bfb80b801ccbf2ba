#include "voxelize/beads/part_outline.h"

#include "toolpaths.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace stratum::voxelize {
namespace {

using test::addArc;
using test::addBead;
using test::allBeads;

using Point = std::array<double, 3>;

double reachOf(const std::vector<Point>& points, const Point& direction) {
    double reach = -1e300;
    for (const Point& p : points)
        reach = std::max(reach, p[0] * direction[0] + p[1] * direction[1] + p[2] * direction[2]);
    return reach;
}

std::vector<Point> cornersOf(const Bounds& box) {
    std::vector<Point> corners;
    for (unsigned n = 0; n < 8; ++n)
        corners.push_back({(n & 1) != 0 ? box.max[0] : box.min[0], (n & 2) != 0 ? box.max[1] : box.min[1],
                           (n & 4) != 0 ? box.max[2] : box.min[2]});
    return corners;
}

// A cone of rings, with a sloped line beside it.
gcode::Toolpath cone() {
    gcode::Toolpath toolpath;
    for (std::uint32_t layer = 1; layer <= 40; ++layer)
        addArc(toolpath, 50, 30, 10.0 - 0.24 * layer, 0.3, 6.28, 0.2 * layer, 0.2 * layer, 0.45, 0.2, layer);
    addBead(toolpath, 40, 30, 0.2, 45, 33, 7, 0.45, 0.2, 1);
    return toolpath;
}

// In any direction it reaches as far as the densely sampled beads, and hardly farther.
TEST(PartOutline, HoldsAllBeadsTightly) {
    const gcode::Toolpath toolpath = cone();
    const auto beads = allBeads(toolpath);
    const Bounds bounds = partBounds(toolpath, gcode::purposesOf(toolpath), beads);
    const std::vector<Point> outline = partOutline(toolpath, gcode::purposesOf(toolpath), beads, bounds);
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    for (int trial = 0; trial < 200; ++trial) {
        Point direction{normal(random), normal(random), normal(random)};
        const double length = std::hypot(direction[0], direction[1], direction[2]);
        for (double& c : direction) c /= length;
        const double flat = std::hypot(direction[0], direction[1]);
        double beads_reach = -1e300;
        for (const gcode::Bead& bead : toolpath.beads)
            for (int n = 0; n <= 200; ++n) {
                double x = std::lerp(double{bead.x0}, double{bead.x1}, n / 200.0);
                double y = std::lerp(double{bead.y0}, double{bead.y1}, n / 200.0);
                if (bead.arc >= 0) {
                    const gcode::Arc& arc = toolpath.arcs[static_cast<std::size_t>(bead.arc)];
                    const double c = std::cos(arc.sweep * n / 200.0);
                    const double s = std::sin(arc.sweep * n / 200.0);
                    const double rx = bead.x0 - arc.center_x;
                    const double ry = bead.y0 - arc.center_y;
                    x = arc.center_x + c * rx - s * ry;
                    y = arc.center_y + s * rx + c * ry;
                }
                const double z = std::lerp(double{bead.z0}, double{bead.z1}, n / 200.0) - 0.1;
                // The bead's ball at that place.
                beads_reach =
                    std::max(beads_reach, x * direction[0] + y * direction[1] + z * direction[2] + 0.1 + 0.125 * flat);
            }
        const double reach = reachOf(outline, direction);
        EXPECT_GE(reach, beads_reach - 0.15);  // square ends of sections are within the box alone; directions between
        EXPECT_LE(reach, beads_reach + 0.35);  // a slab of 0.25 mm, and 0.5 % of the radius
        EXPECT_LE(reach, reachOf(cornersOf(bounds), direction) + 1e-6);
    }
}

TEST(PartOutline, LeavesOutWhatIsBeside) {
    gcode::Toolpath toolpath = cone();
    const std::vector<Point> alone = partOutline(toolpath, gcode::purposesOf(toolpath), allBeads(toolpath),
                                                 partBounds(toolpath, gcode::purposesOf(toolpath), allBeads(toolpath)));
    addBead(toolpath, 0, 0, 0.2, 100, 0, 0.2, 0.45, 0.2, 1);
    toolpath.runs.push_back(toolpath.runs.back());
    toolpath.runs.back().feature = gcode::Feature::skirt;
    toolpath.beads.back().run = static_cast<std::uint32_t>(toolpath.runs.size() - 1);
    const auto beads = allBeads(toolpath);
    EXPECT_EQ(partOutline(toolpath, gcode::purposesOf(toolpath), beads,
                          partBounds(toolpath, gcode::purposesOf(toolpath), beads)),
              alone);
}

TEST(PartOutline, IsTextAndBack) {
    const gcode::Toolpath toolpath = cone();
    const auto beads = allBeads(toolpath);
    const auto purposes = gcode::purposesOf(toolpath);
    const auto outline = placed(partOutline(toolpath, purposes, beads, partBounds(toolpath, purposes, beads)),
                                {.unit = 0.001, .offset = {-50, 7, 0}, .up_y = true});
    const std::vector<Point> read = outlineFromText(textOf(outline));
    ASSERT_EQ(read.size(), outline.size());
    ASSERT_LE(read.size(), kOutlineDirections);
    for (std::size_t n = 0; n < read.size(); ++n)
        for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(read[n][axis], outline[n][axis], 1e-8);
    EXPECT_NEAR(reachOf(read, {0, 1, 0}), 8.0e-3, 1e-7);  // the top is along y
}

TEST(PartOutline, OtherTextIsNoOutline) {
    for (const char* text : {"", "1 2", "1 2 x", "1 2 3 4", "1 2 nan", "1 2 1e999", "1,2,3", "1 2 3 "})
        EXPECT_TRUE(outlineFromText(text).empty()) << text;
    std::string endless;
    for (int n = 0; n < 100000; ++n) endless += "1 2 3 ";
    EXPECT_TRUE(outlineFromText(endless).empty());
}

TEST(PartOutline, OfOneBeadIsItsBox) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 1, 2, 0.2, 4, 2, 0.2, 0.5, 0.2);
    const auto beads = allBeads(toolpath);
    const Bounds bounds = partBounds(toolpath, gcode::purposesOf(toolpath), beads);
    const std::vector<Point> outline = partOutline(toolpath, gcode::purposesOf(toolpath), beads, bounds);
    ASSERT_FALSE(outline.empty());
    for (const Point& p : outline)
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_GE(p[static_cast<std::size_t>(axis)], bounds.min[axis] - 1e-6);  // they are floats
            EXPECT_LE(p[static_cast<std::size_t>(axis)], bounds.max[axis] + 1e-6);
        }
    EXPECT_NEAR(reachOf(outline, {1, 0, 0}), bounds.max[0], 1e-6);
    EXPECT_NEAR(reachOf(outline, {0, 0, 1}), bounds.max[2], 1e-6);
}

}  // namespace
}  // namespace stratum::voxelize
