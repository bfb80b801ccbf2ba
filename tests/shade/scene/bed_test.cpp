#include "shade/scene/bed.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

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

TEST(Backdrop, IsAGradient) {
    const shade::Backdrop backdrop{shade::Color(0.8f), shade::Color(0.2f)};
    EXPECT_FLOAT_EQ(backdrop.radiance({0, 1, 0}).r, 0.8f);
    EXPECT_FLOAT_EQ(backdrop.radiance({0, 0.6f, -0.8f}).r, 0.8f);
    EXPECT_FLOAT_EQ(backdrop.radiance({0, 0, 1}).r, 0.2f);
}

}  // namespace
}  // namespace stratum
