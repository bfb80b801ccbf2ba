#include "shade/integrator/ambient_occlusion.h"

#include "shade/analytic_prints.h"
#include "shade/mean_radiance.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

double openness(const trace::Intersector& print, const shade::SceneDescription& scene, const glm::dvec3& target,
                double distance) {
    const shade::AmbientOcclusion ao(scene, print, distance);
    const auto tracer = print.makeTracer();
    shade::Sampler sampler(1, 4096);
    shade::RayCounts rays;
    shade::TraceContext context{*tracer, sampler, rays};
    trace::Ray ray;
    ray.origin = {0, 0, 20};
    ray.direction = glm::normalize(target - ray.origin);
    double sum = 0.0;
    for (std::uint32_t s = 0; s < 4096; ++s) {
        sampler.start(0, 0, s);
        sum += double(test::radianceOf(ao, ray, context).rgb.r);
    }
    return sum / 4096.0;
}

TEST(AmbientOcclusion, AnOpenPlaneIsOne) {
    const auto none = test::nothing(100.0);
    const auto scene = shade::makeScene({}, none, 8, 8);
    EXPECT_EQ(openness(none, scene, {1, 2, scene.bed->z}, 1e9), 1.0);
}

TEST(AmbientOcclusion, ASphereCoversItsFormFactor) {
    // Below a ball of radius r at height h straight above: cos-weighted cover (r / h)^2.
    const auto ball = test::sphere({0, 0, 4}, 2.0);
    auto scene = shade::makeScene({}, ball, 8, 8);
    scene.bed->z = 0.0;
    scene.bed->fade_begin = 1e6;
    scene.bed->fade_end = 2e6;
    // Seen past the ball: the point 5 from the axis; form factor of a sphere: cos(theta) (r / d)^2.
    const double d2 = 25.0 + 16.0;
    EXPECT_NEAR(openness(ball, scene, {5, 0, 0}, 1e9), 1.0 - 4.0 / std::sqrt(d2) * 4.0 / d2, 2e-3);
    // Too far away to count.
    EXPECT_EQ(openness(ball, scene, {5, 0, 0}, 1.0), 1.0);
}

}  // namespace
}  // namespace stratum
