#include "shade/integrator/path.h"
#include "shade/finish/named_brdf.h"

#include "shade/analytic_prints.h"
#include "shade/brdf/plastic.h"
#include "shade/environment/environment.h"
#include "shade/integrator/render.h"
#include "shade/light/light.h"
#include "shade/mean_radiance.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

using shade::Color;

/// Mean radiance along one ray.
Color mean(const trace::Intersector& print, const shade::SceneDescription& scene, const trace::Ray& ray, int bounces,
           std::uint32_t samples = 4096) {
    return test::meanRadiance(print, shade::PathIntegrator(scene, print, bounces), ray, samples);
}

trace::Ray towards(const glm::dvec3& from, const glm::dvec3& to) {
    trace::Ray ray;
    ray.origin = from;
    ray.direction = glm::normalize(to - from);
    return ray;
}

TEST(Path, FurnaceOnAConvexBodyIsItsAlbedo) {
    const auto ball = test::sphere({0, 0, 0}, 1.0);
    for (const auto& [brdf, albedo] :
         {std::pair{"lambert:0.5,0.8,1", Color(0.5f, 0.8f, 1.0f)}, std::pair{"plastic:1,1,1,0.25", Color(1.0f)}}) {
        const auto scene = test::plainScene(ball, brdf, "constant:1,1,1", false);
        for (const double y : {0.0, 0.6, 0.97}) {
            for (const int bounces : {1, 3}) {
                const Color c = mean(ball, scene, towards({y, 0, 5}, {y, 0, 0}), bounces);
                for (int k = 0; k < 3; ++k) EXPECT_NEAR(c[k], albedo[k], 0.01f) << brdf << " " << y;
            }
        }
    }
}

TEST(Path, FurnaceOnAConcaveBodyIsWhiteWhenAllBouncesCount) {
    // A white vase in a white furnace can't be seen, inside or out.
    test::Vase vase;
    vase.layers = 30;
    const auto print = vase.intersector();
    const auto scene = test::plainScene(print, "lambert:1,1,1", "constant:1,1,1", false);
    const Color deep = mean(print, scene, towards({0, -2, 60}, {0, 0, 1}), 64, 512);
    const Color wall = mean(print, scene, towards({0, -60, 6}, {0, 0, 5}), 64, 512);
    EXPECT_NEAR(deep.r, 1.0f, 0.01f);
    EXPECT_NEAR(wall.r, 1.0f, 0.01f);
}

TEST(Path, DirectionalLightOnPaper) {
    const auto none = test::nothing();
    auto scene = test::plainScene(none, "lambert:1,1,1", "constant:0,0,0", true);
    scene.lights.push_back(std::make_shared<shade::DirectionalLight>(glm::vec3(0, 0.6f, 0.8f), Color(2.0f)));
    scene.backdrop.reset();
    const Color c = mean(none, scene, towards({0, 0, 5}, {0, 0.1, 0}), 3, 16);
    EXPECT_NEAR(c.r, scene.bed->texture.mean().r * 2.0f * 0.8f / 3.14159265f, 1e-5f);
}

TEST(Path, ShadowOfADirectionalLight) {
    const auto ball = test::sphere({0, 0, 3}, 1.0);
    auto scene = test::plainScene(ball, "lambert:0,0,0", "constant:0,0,0", true);
    scene.bed->z = 0.0;
    scene.lights.push_back(std::make_shared<shade::DirectionalLight>(glm::vec3(0, 0, 1), Color(1.0f)));
    EXPECT_EQ(mean(ball, scene, towards({5, 0, 1}, {0.9, 0, 0}), 1, 16).r, 0.0f);
    EXPECT_GT(mean(ball, scene, towards({5, 0, 1}, {1.1, 0, 0}), 1, 16).r, 0.1f);
}

TEST(Path, LampsWithExtentAreSampledInBothWaysToTheSameEnd) {
    // The same integral by the lamp's samples alone. A near lamp over a glossy ball: here both ways have work to do.
    const auto ball = test::sphere({0, 0, 0}, 1.0);
    auto scene = test::plainScene(ball, "plastic:0.6,0.3,0.1,0.15", "constant:0,0,0", false);
    const shade::RectangleLight lamp({0, 0, 2}, {1, 0, 0}, {0, -1, 0}, Color(3.0f));
    scene.lights.push_back(std::make_shared<shade::RectangleLight>(lamp));
    const trace::Ray ray = towards({2, 0, 2}, glm::normalize(glm::dvec3(0.4, 0, 1)));
    const auto tracer = ball.makeTracer();
    trace::Hit hit;
    ASSERT_TRUE(tracer->intersect(ray, hit));
    const shade::Frame frame{glm::vec3(hit.normal)};
    const glm::vec3 wo = frame.toLocal(glm::vec3(-ray.direction));
    double expected = 0.0;
    constexpr int kSide = 512;
    for (int i = 0; i < kSide; ++i) {
        for (int j = 0; j < kSide; ++j) {
            const auto s = lamp.sample(hit.position, {(i + 0.5f) / kSide, (j + 0.5f) / kSide});
            const glm::vec3 wi = frame.toLocal(s->direction);
            if (wi.z > 0.0f) expected += double(scene.material->eval(wo, wi).r * wi.z * s->light.r / s->pdf);
        }
    }
    expected /= kSide * kSide;
    EXPECT_NEAR(mean(ball, scene, ray, 1, 16384).r, expected, 0.01 * expected);
    // The camera doesn't see it.
    EXPECT_EQ(mean(ball, scene, towards({0.9, 0, 1.5}, {0.9, 0, 3}), 1, 4).r, 0.0f);
}

TEST(Path, AStreamAnswersAsItsRaysDoOneByOne) {
    test::Vase vase;
    vase.layers = 40;
    const auto print = vase.intersector();
    for (const bool bed : {true, false}) {
        for (const bool lamps : {true, false}) {
            auto scene = test::plainScene(print, "plastic:0.6,0.3,0.1,0.15", "sky", bed);
            if (lamps)
                scene.lights.push_back(std::make_shared<shade::RectangleLight>(
                    glm::dvec3(0, 0, 40), glm::dvec3(9, 0, 0), glm::dvec3(0, -9, 0), Color(3.0f)));
            const shade::PathIntegrator path(scene, print, 3);
            const auto tracer = print.makeTracer();
            std::vector<trace::Ray> rays;
            std::vector<shade::Sampler> samplers;
            shade::Sampler sampler(7, 4);
            for (int y = 0; y < 24; ++y)
                for (int x = 0; x < 32; ++x) {
                    sampler.start(x, y, 1);
                    rays.push_back(scene.camera.ray(glm::dvec2(x, y) + glm::dvec2(sampler.next2D())));
                    samplers.push_back(sampler);
                }
            std::vector<shade::Sampler> again = samplers;
            std::vector<shade::SurfacePoint> points(rays.size());
            std::vector<shade::Pixel> pixels(rays.size());
            shade::RayCounts counts;
            path.radianceStream(rays, samplers, *tracer, counts, points, pixels);
            shade::RayCounts singles;
            for (std::size_t n = 0; n < rays.size(); ++n) {
                shade::TraceContext context{*tracer, again[n], singles};
                const shade::Pixel one = test::radianceOf(path, rays[n], context);
                ASSERT_EQ(one.rgb, pixels[n].rgb) << n;
                ASSERT_EQ(one.alpha, pixels[n].alpha) << n;
            }
            EXPECT_EQ(counts, singles);
            EXPECT_GT(counts.bounce, 0u);
        }
    }
}

TEST(Path, AmbientLightReachesEverywhere) {
    const auto none = test::nothing();
    auto scene = test::plainScene(none, "lambert:1,1,1", "constant:0,0,0", true);
    scene.ambient = Color(0.5f);
    scene.backdrop.reset();
    EXPECT_NEAR(mean(none, scene, towards({0, 0, 5}, {0, 0.1, 0}), 1, 64).r, 0.5f * scene.bed->texture.mean().r, 1e-5f);
}

// In a hollow every ray meets the surface again: by one bounce or by eight, a white one shows the ambient radiance.
TEST(Path, AmbientLightIsAddedOnceAPath) {
    const auto ball = test::sphere({0, 0, 0}, 10.0);
    const std::shared_ptr<trace::Tracer> tracer = ball.makeTracer();
    const test::FunctionIntersector hollow({{-10, -10, -10}, {10, 10, 10}}, 1e-5,
                                           [&](const trace::Ray& ray, trace::Hit& hit) {
                                               if (!tracer->intersect(ray, hit)) return false;
                                               hit.normal = -hit.normal;
                                               return true;
                                           });
    auto scene = test::plainScene(hollow, "lambert:1,1,1", "constant:0,0,0", false);
    scene.ambient = Color(0.5f);
    for (const int bounces : {1, 2, 8})
        EXPECT_NEAR(mean(hollow, scene, towards({0, 0, 5}, {0, 0, 10}), bounces, 64).r, 0.5f, 1e-5f) << bounces;
}

TEST(Path, EnvironmentSamplingIsUnbiased) {
    // The same integral without importance sampling of the light: uniform directions, no MIS.
    const auto ball = test::sphere({0, 0, 0}, 1.0);
    const auto scene = test::plainScene(ball, "plastic:0.6,0.3,0.1,0.3", "studio", false);
    const glm::vec3 n = glm::normalize(glm::vec3(0.3f, -0.5f, 0.4f));
    const glm::vec3 eye = glm::normalize(glm::vec3(0.5f, -0.8f, 0.1f));
    const shade::Frame frame(n);
    glm::dvec3 expected(0.0);
    constexpr int kSide = 1500;
    for (int i = 0; i < kSide; ++i) {
        for (int j = 0; j < kSide; ++j) {
            const glm::vec3 d = shade::toSphere({(i + 0.5f) / kSide, (j + 0.5f) / kSide});
            const glm::vec3 wi = frame.toLocal(d);
            if (wi.z <= 0.0f) continue;
            expected +=
                glm::dvec3(scene.material->eval(frame.toLocal(eye), wi) * wi.z * scene.environment->radiance(d));
        }
    }
    expected *= 4.0 * std::numbers::pi / kSide / kSide;
    const glm::dvec3 hit(n);
    const Color c = mean(ball, scene, towards(hit + 5.0 * glm::dvec3(eye), hit), 1, 16384);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(c[k], float(expected[k]), 0.01f * float(expected[k]));
}

TEST(Path, BedUnderAnOpenSkyHasItsAlbedo) {
    const auto none = test::nothing();
    const auto scene = test::plainScene(none, "lambert:1,1,1", "constant:1,1,1", true);
    const Color c = mean(none, scene, towards({0, 0, 5}, {0, 0.1, -1}), 3, 256);
    EXPECT_NEAR(c.r, scene.bed->texture.mean().r, 0.002f);
}

// The sun's radiance is its irradiance over 6.7e-5 sr: 1e5 times the room's.
TEST(Path, SharpGlossUnderASunIsFinite) {
    const auto ball = test::sphere({0, 0, 0}, 1.0);
    for (const char* brdf : {"plastic:0.5,0.1,0,0.001", "plastic:0.5,0.1,0,0.005"}) {
        auto scene = test::plainScene(ball, brdf, "constant:1,1,1", false);
        scene.lights.push_back(
            std::make_shared<shade::SunLight>(glm::normalize(glm::vec3(1, 2, 3)), Color(6.7f), 0.53f));
        for (const double y : {0.0, 0.6, 0.97})
            for (const std::uint32_t samples : {1U, 64U}) {
                const Color c = mean(ball, scene, towards({y, 0, 5}, {y, 0, 0}), 8, samples);
                for (int k = 0; k < 3; ++k) EXPECT_TRUE(std::isfinite(c[k]) && c[k] >= 0.0f) << brdf << " " << y;
            }
    }
}

TEST(Path, NonsenseNormalsStayFinite) {
    const test::FunctionIntersector broken({glm::dvec3(-1), glm::dvec3(1)}, 1e-3,
                                           [](const trace::Ray& ray, trace::Hit& hit) {
                                               hit = {1.0, ray.origin + ray.direction, glm::dvec3(std::nan(""))};
                                               return ray.origin.z > 4.5;
                                           });
    auto scene = test::plainScene(broken, shade::kDefaultBrdf, "studio", false);
    const Color c = mean(broken, scene, towards({0, 0, 5}, {0, 0, 0}), 2, 64);
    EXPECT_TRUE(shade::isFinite(c));
    EXPECT_GT(c.r, 0.0f);
}

}  // namespace
}  // namespace stratum
