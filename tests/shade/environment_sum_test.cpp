#include "shade/environment_sum.h"

#include "shade/analytic_prints.h"
#include "shade/path.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

using shade::Color;

shade::SceneDescription sceneOf(const march::Intersector& print, const char* env) {
    shade::SceneOptions options;
    options.brdf = "plastic:0.6,0.3,0.1,0.5";
    options.env = env;
    options.bed = false;
    return shade::makeScene(options, print, 32, 24);
}

Color mean(const march::Intersector& print, const shade::Integrator& integrator, const march::Ray& ray,
           std::uint32_t samples) {
    const auto tracer = print.makeTracer();
    shade::Sampler sampler(1, samples);
    shade::RayCounts rays;
    shade::TraceContext context{*tracer, sampler, rays};
    glm::dvec3 sum(0.0);
    for (std::uint32_t s = 0; s < samples; ++s) {
        sampler.start(0, 0, s);
        sum += glm::dvec3(integrator.radiance(ray, context).rgb);
    }
    return Color(sum / double(samples));
}

TEST(EnvironmentSum, ApproachesTheIntegralAsCellsGetSmaller) {
    const auto ball = test::sphere({0, 0, 0}, 1.0);
    march::Ray ray;
    ray.origin = {1.5, -2, 2};
    ray.direction = glm::normalize(glm::dvec3(0.2, -0.3, 0.4) - ray.origin);
    for (const char* env : {"studio", "constant:1,1,1", "sky:40,20,3"}) {
        const auto scene = sceneOf(ball, env);
        const Color truth = mean(ball, shade::PathIntegrator(scene, ball, 1), ray, 8192);
        double last = 1.0;
        for (const int rows : {8, 32, 128}) {
            const Color sum = mean(ball, shade::EnvironmentSum(scene, ball, rows), ray, 1);
            last = std::abs(double(shade::luminance(sum) / shade::luminance(truth)) - 1.0);
        }
        EXPECT_LT(last, 0.02) << env;
    }
}

TEST(EnvironmentSum, HasNoNoise) {
    const auto ball = test::sphere({0, 0, 0}, 1.0);
    const auto scene = sceneOf(ball, "studio");
    const shade::EnvironmentSum sum(scene, ball, 16);
    march::Ray ray;
    ray.origin = {0, 0, 5};
    ray.direction = {0, 0, -1};
    const Color one = mean(ball, sum, ray, 1);
    const Color many = mean(ball, sum, ray, 16);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(one[c], many[c], 1e-6f * one[c]);
}

}  // namespace
}  // namespace stratum
