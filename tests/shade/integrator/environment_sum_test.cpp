#include "shade/integrator/environment_sum.h"

#include "shade/analytic_prints.h"
#include "shade/integrator/path.h"
#include "shade/mean_radiance.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

using shade::Color;

constexpr const char* kPlastic = "plastic:0.6,0.3,0.1,0.5";

TEST(EnvironmentSum, ApproachesTheIntegralAsCellsGetSmaller) {
    const auto ball = test::sphere({0, 0, 0}, 1.0);
    trace::Ray ray;
    ray.origin = {1.5, -2, 2};
    ray.direction = glm::normalize(glm::dvec3(0.2, -0.3, 0.4) - ray.origin);
    for (const char* env : {"studio", "constant:1,1,1", "sky:40,20,3"}) {
        const auto scene = test::plainScene(ball, kPlastic, env, false);
        const Color truth = test::meanRadiance(ball, shade::PathIntegrator(scene, ball, 1), ray, 8192);
        double last = 1.0;
        for (const int rows : {8, 32, 128}) {
            const Color sum = test::meanRadiance(ball, shade::EnvironmentSum(scene, ball, rows), ray, 1);
            last = std::abs(double(shade::luminance(sum) / shade::luminance(truth)) - 1.0);
        }
        EXPECT_LT(last, 0.02) << env;
    }
}

TEST(EnvironmentSum, HasNoNoise) {
    const auto ball = test::sphere({0, 0, 0}, 1.0);
    const auto scene = test::plainScene(ball, kPlastic, "studio", false);
    const shade::EnvironmentSum sum(scene, ball, 16);
    trace::Ray ray;
    ray.origin = {0, 0, 5};
    ray.direction = {0, 0, -1};
    const Color one = test::meanRadiance(ball, sum, ray, 1);
    const Color many = test::meanRadiance(ball, sum, ray, 16);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(one[c], many[c], 1e-6f * one[c]);
}

}  // namespace
}  // namespace stratum
