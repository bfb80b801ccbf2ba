#include "animate/camera_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>

namespace stratum::animate {
namespace {

TEST(MonotoneCubic, PassesThroughItsPointsExactly) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> step(0.01, 3.0);
    std::uniform_real_distribution<double> value(-100.0, 100.0);
    for (const std::size_t count : {1u, 2u, 3u, 4u, 17u}) {
        std::vector<double> places{value(random)};
        std::vector<double> values{value(random)};
        while (places.size() < count) {
            places.push_back(places.back() + step(random));
            values.push_back(value(random));
        }
        const MonotoneCubic curve(places, values);
        for (std::size_t n = 0; n < count; ++n) EXPECT_EQ(curve(places[n]), values[n]) << n << " of " << count;
        EXPECT_EQ(curve(places.front() - 9), values.front());
        EXPECT_EQ(curve(places.back() + 9), values.back());
    }
}

TEST(MonotoneCubic, StaysBetweenNeighboursAndHasNoKinks) {
    const std::vector<double> places{0, 0.1, 2, 2.5, 6, 7};
    const std::vector<double> values{0, 5, 5.1, -3, -3, 8};
    const MonotoneCubic curve(places, values);
    constexpr double kStep = 1e-4;
    double slope_before = (curve(kStep) - curve(0)) / kStep;
    double steepest_turn = 0;
    for (int n = 0; n < 69990; ++n) {
        const double at = n * kStep;
        const double now = curve(at);
        const auto next = static_cast<std::size_t>(std::upper_bound(places.begin(), places.end(), at) - places.begin());
        const auto [low, high] = std::minmax(values[next - 1], values[next]);
        ASSERT_GE(now, low - 1e-12) << at;
        ASSERT_LE(now, high + 1e-12) << at;
        const double slope = (curve(at + kStep) - now) / kStep;
        // The first piece is short and steep: its curvature bounds what a step may change.
        steepest_turn = std::max(steepest_turn, std::abs(slope - slope_before));
        slope_before = slope;
    }
    EXPECT_LT(steepest_turn, 0.5);  // a kink there would be of 50
}

TEST(MonotoneCubic, FollowsAStraightLineAndNearlyACircle) {
    const MonotoneCubic line({0, 1, 3, 4}, {2, 4, 8, 10});
    EXPECT_NEAR(line(2.2), 6.4, 1e-12);
    std::vector<double> places;
    std::vector<double> values;
    for (int n = 0; n <= 24; ++n) {
        places.push_back(n * 0.25);
        values.push_back(std::sin(places.back()));
    }
    const MonotoneCubic wave(places, values);
    double worst = 0;
    for (int n = 0; n < 6000; ++n) worst = std::max(worst, std::abs(wave(n * 1e-3) - std::sin(n * 1e-3)));
    EXPECT_LT(worst, 0.01);
}

}  // namespace
}  // namespace stratum::animate
