#include "shade/light/light.h"

#include "shade/sphere_checks.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <cmath>
#include <numbers>
#include <random>

namespace stratum {
namespace {

using shade::Color;

TEST(DirectionalLight, IsTheSameEverywhere) {
    const shade::DirectionalLight light({0, 0, 1}, Color(1, 2, 3));
    for (const double x : {0.0, 1e6}) {
        const auto s = light.sample(glm::dvec3(x), {0.5f, 0.5f});
        ASSERT_TRUE(s);
        EXPECT_EQ(s->light, Color(1, 2, 3));
        EXPECT_EQ(s->pdf, 0.0f);
    }
    EXPECT_FALSE(light.hasExtent());
    EXPECT_FALSE(light.intersect({}));
}

TEST(SunLight, SamplesItsDensity) {
    const glm::vec3 to = glm::normalize(glm::vec3(1, -2, 3));
    for (const float diameter : {2.0f, 20.0f}) {
        const shade::SunLight sun(to, Color(2.0f), diameter);
        const auto density = [&](const glm::vec3& d) {
            trace::Ray ray;
            ray.direction = glm::normalize(glm::dvec3(d));
            const auto met = sun.intersect(ray);
            return met ? double(met->pdf) : 0.0;
        };
        const auto draw = [&](const glm::vec2& u) -> std::optional<glm::vec3> {
            return sun.sample(glm::dvec3(0.0), u)->direction;
        };
        // Cells that end with the disc: those that its rim cuts would test the quadrature.
        const double rim = 0.4999 * double(diameter) * std::numbers::pi / 180.0;
        EXPECT_LT(test::chiSquaredZ(to, rim, draw, density, 200000, 5), 4.0) << diameter;
    }
}

TEST(SunLight, IsAsBrightAndAsWideAsItSays) {
    for (const float diameter : {0.05f, 0.53f, 20.0f}) {
        const glm::vec3 to = glm::normalize(glm::vec3(1, -2, 3));
        const shade::SunLight sun(to, Color(2.0f), diameter);
        double irradiance = 0.0;
        double farthest = 0.0;
        constexpr int kSide = 128;
        for (int i = 0; i < kSide; ++i) {
            for (int j = 0; j < kSide; ++j) {
                const auto s = sun.sample(glm::dvec3(0.0), {(i + 0.5f) / kSide, (j + 0.5f) / kSide});
                ASSERT_TRUE(s);
                irradiance += double(s->light.r) * double(glm::dot(s->direction, to)) / double(s->pdf);
                const double angle = 2.0 * std::asin(0.5 * double(glm::length(s->direction - to)));
                farthest = std::max(farthest, angle);
                // What is drawn is met, but for rounding at the rim.
                trace::Ray ray;
                ray.direction = glm::normalize(glm::dvec3(s->direction));
                if (angle < 0.49 * double(diameter) * std::numbers::pi / 180.0) {
                    const auto met = sun.intersect(ray);
                    ASSERT_TRUE(met);
                    EXPECT_EQ(met->pdf, s->pdf);
                    EXPECT_EQ(met->radiance, s->light);
                }
            }
        }
        EXPECT_NEAR(irradiance / kSide / kSide, 2.0, 2e-3) << diameter;
        EXPECT_NEAR(farthest * 180.0 / std::numbers::pi, 0.5 * double(diameter), 0.01 * double(diameter));
    }
    trace::Ray ray;
    ray.direction = {0, 0, 1};
    EXPECT_FALSE(shade::SunLight({1, 0, 0}, Color(1.0f), 90.0f).intersect(ray));
}

}  // namespace
}  // namespace stratum
