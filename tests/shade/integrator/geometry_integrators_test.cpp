#include "shade/integrator/geometry_integrators.h"

#include "shade/analytic_prints.h"
#include "shade/mean_radiance.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

TEST(GeometryIntegrators, OfASphere) {
    const auto ball = test::sphere({0, 0, 0}, 2.0);
    shade::SceneOptions options;
    options.bed = false;
    const auto scene = shade::makeScene(options, ball, 8, 8);
    const shade::NormalIntegrator normal(scene, ball);
    const shade::DepthIntegrator depth(scene, ball);
    const auto tracer = ball.makeTracer();
    shade::Sampler sampler(0, 1);
    shade::RayCounts rays;
    shade::TraceContext context{*tracer, sampler, rays};
    trace::Ray ray;
    ray.origin = {0, -5, 0};
    ray.direction = {0, 1, 0};
    EXPECT_EQ(test::radianceOf(normal, ray, context).rgb, shade::Color(0, -1, 0));
    EXPECT_EQ(test::radianceOf(depth, ray, context).rgb.r, 3.0f);
    // From inside the surface faces the eye.
    ray.origin = {0, 0, 0};
    EXPECT_EQ(test::radianceOf(normal, ray, context).rgb, shade::Color(0, -1, 0));
    ray.direction = {0, 0, 1};
    ray.origin = {0, 0, 3};
    EXPECT_EQ(test::radianceOf(depth, ray, context).alpha, 0.0f);
    EXPECT_EQ(rays.primary, 4u);
    EXPECT_EQ(rays.total(), 4u);

    const shade::PositionIntegrator position(scene, ball);
    const shade::MaskIntegrator mask(scene, ball);
    EXPECT_EQ(test::radianceOf(mask, ray, context).alpha, 0.0f);
    ray.origin = {0, -5, 0};
    ray.direction = {0, 1, 0};
    EXPECT_EQ(test::radianceOf(mask, ray, context).rgb, shade::Color(1.0f));
    EXPECT_EQ(test::radianceOf(position, ray, context).rgb, shade::Color(0, -2, 0));
}

}  // namespace
}  // namespace stratum
