#include "voxelize/beads/settling.h"

#include "settled_field.h"
#include "voxelize/beads/bead_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace stratum::voxelize {
namespace {

// As the kernels read the table.
double tableLevel(const SettlingCurve& curve, double m) {
    const double q = std::clamp((m - curve.closing()) / (1 - curve.closing()), 0.0, 1.0);
    const double at = (1 - std::sqrt(1 - std::sqrt(q))) * SettlingCurve::kSteps;
    const auto step = std::min(static_cast<std::size_t>(at), std::size_t{SettlingCurve::kSteps - 1});
    const double low = static_cast<double>(curve.table()[step]);
    const double high = static_cast<double>(curve.table()[step + 1]);
    return low + (at - static_cast<double>(step)) * (high - low);
}

TEST(Settling, APairKeepsItsVolumeAtTwentySpacingsAndThreeRadii) {
    constexpr double kHeight = 0.2;
    constexpr double kWidth = 0.45;
    const double area = gcode::sectionArea(kWidth, kHeight);
    for (const double radius : {0.1, 0.05, 0.02}) {
        const SettlingCurve curve(kHeight / radius, 0.02);
        const test::GrooveOracle groove(kHeight, radius);
        const double flat = kWidth / 2 - flatInset(kHeight, radius);
        for (int n = 0; n < 20; ++n) {
            const double spacing = 2 * flat + 2 * radius * (0.5 + 0.55 * n / 19);
            const double m = (spacing - 2 * flat) / 2;
            const double level = radius * tableLevel(curve, m / radius);
            const double union_area = 2 * area - (m < radius ? groove.claimedTwice(m) : 0);
            const double settled = union_area + (m < radius ? groove.filled(m, std::min(level, m)) : 0);
            const double open = groove.filled(std::min(m, radius), 0);
            const double over = m < radius ? std::max(groove.claimedTwice(m) - open, 0.0) : 0;
            EXPECT_NEAR(settled + over, 2 * area, 1e-6 * 2 * area) << radius << " at " << spacing;
        }
    }
}

TEST(Settling, ClosesAtTheSlicersSpacing) {
    // Slic3r's flow: neighbours are width - height (1 - pi / 4) apart, which is the area over the height.
    for (const double radius : {0.1, 0.06, 0.01}) {
        const double height = 0.2;
        const double width = 0.5;
        const SettlingCurve curve(height / radius, 0.02);
        const double flat = width / 2 - flatInset(height, radius);
        EXPECT_NEAR(2 * flat + 2 * radius * curve.closing(), gcode::sectionArea(width, height) / height, 1e-12);
    }
}

TEST(Settling, LevelsRiseFromNothingToTheEdgeWithTheGap) {
    for (const double ratio : {2.0, 2.2, 5.0, 50.0}) {
        const SettlingCurve curve(ratio, 0.02);
        const test::GrooveOracle groove(ratio, 1);
        EXPECT_EQ(curve.level(curve.closing()), 0);
        EXPECT_EQ(curve.level(1), 1);
        EXPECT_EQ(curve.table().front(), 0);
        EXPECT_EQ(curve.table().back(), 1);
        double before = 0;
        for (int n = 1; n <= 50; ++n) {
            const double m = curve.closing() + (1 - curve.closing()) * n / 50;
            const double level = curve.level(m);
            EXPECT_GE(level, before);
            EXPECT_LE(level, m);
            EXPECT_NEAR(level, groove.level(m), 2e-6) << ratio << ", " << m;
            EXPECT_NEAR(level, tableLevel(curve, m), 5e-6) << ratio << ", " << m;
            before = level;
        }
    }
}

TEST(Settling, WeldsReachGroovesAsShallowAsTheirGap) {
    for (const double radius : {0.1, 0.05}) {
        const SettlingCurve curve(0.2 / radius, 0.02);
        EXPECT_NEAR(test::GrooveOracle(0.2, radius).depth(radius * curve.weldLevel()), 0.02 * 0.2, 1e-9);
    }
    EXPECT_EQ(SettlingCurve(1000, 0.02).weldLevel(), 1);
}

}  // namespace
}  // namespace stratum::voxelize
