#include "gcode/toolpath/toolpath.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace stratum::gcode {
namespace {

TEST(Toolpath, FeatureNamesGoBothWays) {
    for (std::size_t i = 0; i < kFeatureCount; ++i) {
        const auto feature = static_cast<Feature>(i);
        EXPECT_FALSE(featureName(feature).empty());
        EXPECT_EQ(featureNamed(featureName(feature)), feature);
    }
    EXPECT_EQ(featureName(Feature::external_perimeter), "external-perimeter");
    EXPECT_EQ(featureName(Feature::wipe_tower), "wipe-tower");
    EXPECT_EQ(featureNamed("nonsense"), Feature::count_);
    EXPECT_EQ(featureName(Feature::count_), "unknown");
}

TEST(Toolpath, StadiumSection) {
    // 0.45 x 0.2: a 0.25 x 0.2 rectangle and a disc of diameter 0.2.
    EXPECT_DOUBLE_EQ(sectionArea(0.45, 0.2), 0.25 * 0.2 + std::numbers::pi / 4 * 0.04);
    EXPECT_DOUBLE_EQ(sectionArea(0.2, 0.2), std::numbers::pi / 4 * 0.04);
    EXPECT_DOUBLE_EQ(sectionArea(0.1, 0.2), std::numbers::pi / 4 * 0.01);  // round, thinner than the layer
}

TEST(Toolpath, WidthIsTheInverseOfArea) {
    for (const double height : {0.05, 0.2, 0.35, 1.0})
        for (double width = 0.01; width < 3; width += 0.037)
            EXPECT_NEAR(sectionWidth(sectionArea(width, height), height), width, 1e-12) << width << " x " << height;
}

TEST(Toolpath, LengthOfStraightAndArc) {
    Toolpath toolpath;
    toolpath.runs.push_back({.height = 0.2F});
    toolpath.arcs.push_back({.center_x = 0, .center_y = 0, .sweep = -std::numbers::pi / 2});
    toolpath.beads.push_back({.x0 = 0, .y0 = 0, .z0 = 0, .x1 = 3, .y1 = 4, .z1 = 12, .width = 0.4F});
    toolpath.beads.push_back({.x0 = 0, .y0 = 2, .z0 = 1, .x1 = 2, .y1 = 0, .z1 = 1, .width = 0.4F, .arc = 0});
    EXPECT_DOUBLE_EQ(beadLength(toolpath, toolpath.beads[0]), 13);
    EXPECT_DOUBLE_EQ(beadLength(toolpath, toolpath.beads[1]), std::numbers::pi);
    EXPECT_NEAR(beadVolume(toolpath), (13 + std::numbers::pi) * sectionArea(0.4, 0.2), 1e-6);
}

}  // namespace
}  // namespace stratum::gcode
