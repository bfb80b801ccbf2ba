#include "shade/scene/bed.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <random>

namespace stratum {
namespace {

TEST(Bed, IsMetFromAboveOnly) {
    shade::Bed bed;
    bed.z = 2.0;
    trace::Ray ray;
    ray.origin = {0, 0, 5};
    ray.direction = glm::normalize(glm::dvec3(0, 3, -3));
    EXPECT_NEAR(bed.intersect(ray).value(), std::sqrt(18.0), 1e-12);
    ray.t_max = 4.0;
    EXPECT_FALSE(bed.intersect(ray));
    ray.t_max = 1e9;
    ray.direction.z = 0.0;
    EXPECT_FALSE(bed.intersect(ray));
    ray.origin.z = -5;
    ray.direction = {0, 0, 1};
    EXPECT_FALSE(bed.intersect(ray));
}

TEST(Bed, FadesFromNoneToAll) {
    shade::Bed bed;
    bed.center = {10, 0};
    bed.fade_begin = 5;
    bed.fade_end = 9;
    EXPECT_EQ(bed.fade({10, 5, 0}), 0.0);
    EXPECT_EQ(bed.fade({10, 9, 0}), 1.0);
    EXPECT_NEAR(bed.fade({17, 0, 0}), 0.5, 1e-12);
}

TEST(Bed, FadesByTheFormulaOnBothSidesOfItsEnds) {
    shade::Bed bed;
    bed.center = {-3.7, 11.3};
    bed.fade_begin = 41.3;
    bed.fade_end = 187.9;
    std::mt19937 random(5);
    std::uniform_real_distribution<double> place(-300.0, 300.0);
    const auto expect = [&](double x, double y) {
        const double r = glm::length(glm::dvec2(x, y) - bed.center);
        const double t = std::clamp((r - bed.fade_begin) / (bed.fade_end - bed.fade_begin), 0.0, 1.0);
        EXPECT_EQ(bed.fade({x, y, 7.0}), t * t * t * (t * (6.0 * t - 15.0) + 10.0)) << x << ", " << y;
    };
    for (int n = 0; n < 10000; ++n) expect(place(random), place(random));
    for (const double end : {bed.fade_begin, bed.fade_end})
        for (double x = bed.center.x + end - 1e-13; x < bed.center.x + end + 1e-13; x = std::nextafter(x, 1e9))
            expect(x, bed.center.y);
}

TEST(Bed, BlocksWhatMeetsIt) {
    shade::Bed bed;
    bed.z = -0.25;
    std::mt19937 random(6);
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    for (int n = 0; n < 10000; ++n) {
        trace::Ray ray;
        ray.origin = {number(random), number(random), number(random)};
        ray.direction = glm::normalize(glm::dvec3(number(random), number(random), n % 7 == 0 ? 0.0 : number(random)));
        if (n % 3 == 0) ray.t_max = 1.0 + number(random);
        EXPECT_EQ(bed.blocks(ray), bed.intersect(ray).has_value());
    }
}

TEST(Backdrop, IsAGradient) {
    const shade::Backdrop backdrop{shade::Color(0.8f), shade::Color(0.2f)};
    EXPECT_FLOAT_EQ(backdrop.radiance({0, 1, 0}).r, 0.8f);
    EXPECT_FLOAT_EQ(backdrop.radiance({0, 0.6f, -0.8f}).r, 0.8f);
    EXPECT_FLOAT_EQ(backdrop.radiance({0, 0, 1}).r, 0.2f);
}

}  // namespace
}  // namespace stratum
