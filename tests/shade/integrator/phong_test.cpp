#include "shade/integrator/phong.h"

#include "shade/analytic_prints.h"
#include "shade/environment/environment.h"
#include "shade/light/light.h"
#include "shade/mean_radiance.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

using shade::Color;

shade::SceneDescription sceneOf(const trace::Intersector& print) {
    shade::SceneOptions options;
    options.brdf = "lambert:1,0.5,0";
    options.env = "constant:0.9,0.9,0.9";
    options.bed = false;
    return shade::makeScene(options, print, 32, 24);
}

Color along(const trace::Intersector& print, const shade::SceneDescription& scene, const shade::PhongOptions& options,
            const glm::dvec3& origin, const glm::dvec3& direction) {
    const shade::PhongIntegrator phong(scene, print, options);
    const auto tracer = print.makeTracer();
    shade::Sampler sampler(1, 1);
    shade::RayCounts rays;
    shade::TraceContext context{*tracer, sampler, rays};
    trace::Ray ray;
    ray.origin = origin;
    ray.direction = glm::normalize(direction);
    return test::radianceOf(phong, ray, context).rgb;
}

TEST(Phong, AddsItsTerms) {
    const auto ball = test::sphere({0, 0, 0}, 1.0);
    auto scene = sceneOf(ball);
    scene.ambient = Color(0.2f);
    scene.lights.push_back(std::make_shared<shade::DirectionalLight>(glm::vec3(0.6f, 0, 0.8f), Color(0.5f)));
    shade::PhongOptions options;
    options.shininess = 4.0f;
    options.reflective = 0.0f;
    const Color c = along(ball, scene, options, {0, 0, 5}, {0, 0, -1});
    // n = v = z here: r.v = n.l.
    const float expected = 0.2f + 0.5f * (0.8f + std::pow(0.8f, 4.0f));
    EXPECT_NEAR(c.r, expected, 1e-5f);
    EXPECT_NEAR(c.g, 0.5f * expected, 1e-5f);
    EXPECT_EQ(c.b, 0.0f);
    options.specular = 0.0f;
    EXPECT_NEAR(along(ball, scene, options, {0, 0, 5}, {0, 0, -1}).r, 0.2f + 0.4f, 1e-5f);
}

TEST(Phong, PointLightsDoNotFade) {
    const auto ball = test::sphere({0, 0, 0}, 1.0);
    for (const double height : {2.0, 200.0}) {
        auto scene = sceneOf(ball);
        scene.lights.push_back(std::make_shared<shade::PointLight>(glm::dvec3(0, 0, height), Color(0.6f)));
        shade::PhongOptions options;
        options.specular = options.reflective = 0.0f;
        EXPECT_NEAR(along(ball, scene, options, {0, 0, 1.5}, {0, 0, -1}).r, 0.6f, 1e-4f) << height;
    }
}

TEST(Phong, ShadowsAreHard) {
    const auto ball = test::sphere({0, 0, 3}, 1.0);
    auto scene = sceneOf(ball);
    scene.bed = shade::Bed{};
    scene.bed->texture = shade::BedTexture(Color(1.0f));
    scene.bed->fade_begin = 1e6;
    scene.bed->fade_end = 2e6;
    scene.lights.push_back(std::make_shared<shade::DirectionalLight>(glm::vec3(0, 0, 1), Color(1.0f)));
    shade::PhongOptions options;
    options.specular = 0.0f;
    EXPECT_EQ(along(ball, scene, options, {5, 0, 1}, glm::dvec3(0.99, 0, 0) - glm::dvec3(5, 0, 1)).r, 0.0f);
    EXPECT_NEAR(along(ball, scene, options, {5, 0, 1}, glm::dvec3(1.01, 0, 0) - glm::dvec3(5, 0, 1)).r, 1.0f, 1e-5f);
}

TEST(Phong, MirrorsShowWhatIsThereFiveTimesAtMost) {
    const auto ball = test::sphere({0, 0, 0}, 1.0);
    auto scene = sceneOf(ball);
    scene.ambient = Color(1.0f);
    shade::PhongOptions options;
    options.reflective = 0.25f;
    // Straight back: the mirror shows the surroundings.
    EXPECT_NEAR(along(ball, scene, options, {0, 0, 5}, {0, 0, -1}).b, 0.25f * 0.9f, 1e-5f);
    // Inside a mirror ball light goes round; every visit adds (1 - kr) kr^n of the surface, six visits in all.
    const double k = 0.25;
    EXPECT_NEAR(along(ball, scene, options, {0, 0, 0.3}, {0.2, 0.3, -1}).r, 1.0 - std::pow(k, 6), 1e-5);
}

TEST(Phong, BringsItsOwnLightIfThereIsNone) {
    const auto ball = test::sphere({0, 0, 0}, 1.0);
    const auto scene = sceneOf(ball);
    EXPECT_GT(along(ball, scene, {}, scene.camera.eye(), scene.camera.forward()).r, 0.3f);
}

}  // namespace
}  // namespace stratum
