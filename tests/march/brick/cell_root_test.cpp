#include "march/brick/cell_root.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace stratum::march {
namespace {

double refinedOrNan(const SegmentCubic& f) {
    const auto bracket = firstCrossing(f);
    return bracket ? refineRoot(f, *bracket) : std::nan("");
}

TEST(CellRoot, TheCubicIsTheTrilinearFieldAlongTheSegment) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> value(-1, 1);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int n = 0; n < 2000; ++n) {
        Corners v;
        for (double& corner : v) corner = value(random);
        const glm::dvec3 from(unit(random), unit(random), unit(random));
        const glm::dvec3 to(unit(random), unit(random), unit(random));
        const SegmentCubic f(v, from, to);
        for (const double s : {0.0, 0.2, 0.7, 1.0}) {
            EXPECT_NEAR(f(s), interpolate(v, from + s * (to - from)), 1e-14);
            const double h = 1e-6;
            EXPECT_NEAR(f.slope(s), (f(s + h) - f(s - h)) / (2 * h), 1e-8);
        }
    }
}

// Rule 4 of the numerics: equal signs at the ends don't mean that there is no hit.
TEST(CellRoot, EqualEndSignsMayHideTwoCrossings) {
    // Outside at both ends of the diagonal, inside in the middle.
    const Corners v = {1, -1, -1, -1, -1, -1, -1, 1};
    const SegmentCubic f(v, {0, 0, 0}, {1, 1, 1});
    ASSERT_GT(f(0), 0);
    ASSERT_GT(f(1), 0);
    ASSERT_LT(f(0.5), 0);
    const double s = refinedOrNan(f);
    EXPECT_NEAR(f(s), 0, 1e-12);
    EXPECT_LT(s, 0.5);
}

// A flat on a voxel plane: the face that the ray leaves by is exactly 0, which counts as outside.
TEST(CellRoot, AZeroAtTheEndIsNotTheCrossingBeforeIt) {
    const Corners out = {-0.2, 0, 0.6, 0, -0.2, 0, 0.6, 0};
    const SegmentCubic leaving(out, {0.5, 0, 0}, {0.5, 1, 1});
    ASSERT_LT(leaving.c0, 0);
    ASSERT_EQ(leaving.end, 0);
    EXPECT_NEAR(refinedOrNan(leaving), 0.25, 1e-15);
    // The same from the zero: the start is the surface itself, the hit is where the ray enters.
    const Corners in = {0, 0.6, 0, -0.2, 0, 0.6, 0, -0.2};
    const SegmentCubic entering(in, {0.5, 0, 0}, {0.5, 1, 1});
    ASSERT_EQ(entering.c0, 0);
    ASSERT_LT(entering.end, 0);
    EXPECT_NEAR(refinedOrNan(entering), 0.75, 1e-15);
}

// Where layers touch, a ray inside comes to a voxel plane at -1e-16 and turns back inside: no crossing, though a zero
// is less than a rounding before the segment. The crossing is where the ray leaves later on.
TEST(CellRoot, AZeroJustBeforeTheSegmentIsNotTheCrossing) {
    const Corners v = {-0x1p-53, 0.5, -0x1p-53, 0.5, -0x1p-53, -0.25, -0x1p-53, -0.25};
    const SegmentCubic f(v, {0.75, 0, 0}, {0, 0, 1});  // -0.0625 s + 0.5625 s^2
    ASSERT_LT(f.c0, 0);
    ASSERT_LT(f.slope(0), 0);
    ASSERT_GT(f.end, 0);
    EXPECT_NEAR(refinedOrNan(f), 1.0 / 9, 1e-14);
    // The same backwards: the zero is beyond the end.
    const SegmentCubic back(v, {0, 0, 1}, {0.75, 0, 0});
    EXPECT_NEAR(refinedOrNan(back), 8.0 / 9, 1e-14);
}

// The chord from (0, -27) to (1, 81) is zero at 1/4, where the slope is 0 and the field is not.
TEST(CellRoot, NoSlopeIsNoZero) {
    const Corners v = {-27, -23, -23, -51, -23, -51, -51, 81};
    const SegmentCubic f(v, {0, 0, 0}, {1, 1, 1});
    ASSERT_EQ(f.slope(0.25), 0);
    ASSERT_EQ(f(0.25), -27);
    EXPECT_NEAR(f(refinedOrNan(f)), 0, 1e-12);
}

TEST(CellRoot, FindsTheFirstRootOfAnyCubic) {
    // Against a scan in 2000 steps, which may itself miss a pair of roots closer than that.
    std::mt19937 random(2);
    std::uniform_real_distribution<double> value(-1, 1);
    std::uniform_real_distribution<double> unit(0, 1);
    int found = 0;
    int several = 0;
    int disagree = 0;
    for (int n = 0; n < 100000; ++n) {
        Corners v;
        for (double& corner : v) corner = value(random);
        const glm::dvec3 from(unit(random), unit(random), 0);
        const glm::dvec3 to(unit(random), unit(random), 1);
        const SegmentCubic f(v, from, to);
        const double s = refinedOrNan(f);
        constexpr int kSteps = 2000;
        double expected = std::nan("");
        int changes = 0;
        for (int k = 0; k < kSteps; ++k)
            if (isInside(f((k + 1.0) / kSteps)) != isInside(f(static_cast<double>(k) / kSteps))) {
                if (changes++ == 0) expected = (k + 0.5) / kSteps;
            }
        found += changes > 0 ? 1 : 0;
        several += changes > 1 ? 1 : 0;
        const bool same =
            std::isnan(s) == std::isnan(expected) && (std::isnan(s) || std::abs(s - expected) <= 0.6 / kSteps);
        disagree += same ? 0 : 1;
        EXPECT_TRUE(std::isnan(s) || std::abs(f(s)) <= 1e-12) << n << ": " << f(s);
    }
    EXPECT_GT(found, 40000);
    EXPECT_GT(several, 2000);
    EXPECT_LE(disagree, 20);
}

TEST(CellRoot, ZeroIsOutside) {
    // The field is zero on one face and positive beyond: no crossing, whichever way.
    const Corners touching = {0, 0, 0, 0, 1, 1, 1, 1};
    EXPECT_FALSE(firstCrossing(SegmentCubic(touching, {1, 0.5, 0.5}, {0, 0.5, 0.5})));
    EXPECT_FALSE(firstCrossing(SegmentCubic(touching, {0, 0.5, 0.5}, {1, 0.5, 0.5})));
    // Zero on one face and negative on the other: the crossing is on that face, exactly, from either side. Steps that
    // must stay inside the bracket would only halve it, 26 times for 1e-8.
    const Corners inside = {0, 0, 0, 0, -1, -1, -1, -1};
    EXPECT_EQ(refinedOrNan(SegmentCubic(inside, {0, 0.5, 0.5}, {1, 0.5, 0.5})), 0);
    EXPECT_EQ(refinedOrNan(SegmentCubic(inside, {1, 0.5, 0.5}, {0, 0.5, 0.5})), 1);
}

}  // namespace
}  // namespace stratum::march
