#include "shade/light/light.h"

#include "shade/sphere_checks.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <cmath>
#include <numbers>

namespace stratum {
namespace {

using shade::Color;
using shade::RectangleLight;

/// Irradiance of a horizontal surface from a horizontal rectangle above, by area.
double byArea(double cx, double cy, double z, double a, double b) {
    constexpr int kSide = 600;
    double sum = 0.0;
    for (int i = 0; i < kSide; ++i) {
        for (int j = 0; j < kSide; ++j) {
            const double x = cx + a * (2.0 * (i + 0.5) / kSide - 1.0);
            const double y = cy + b * (2.0 * (j + 0.5) / kSide - 1.0);
            const double r2 = x * x + y * y + z * z;
            sum += z * z / (r2 * r2);
        }
    }
    return sum * 4.0 * a * b / kSide / kSide;
}

TEST(RectangleLight, GivesTheIrradianceOfItsArea) {
    struct Case {
        double x, y, z, a, b;
    };
    for (const Case c :
         {Case{0, 0, 2, 1, 1}, {3, -1, 0.5, 2, 0.3}, {0.1, 0.2, 0.05, 1, 2}, {0, 5, 300, 2, 3}, {10, 20, 5000, 1, 1}}) {
        const RectangleLight light({c.x, c.y, c.z}, {c.a, 0, 0}, {0, -c.b, 0}, Color(1.0f));
        const double expected = byArea(c.x, c.y, c.z, c.a, c.b);
        EXPECT_NEAR(double(shade::irradianceFrom(light, glm::dvec3(0.0)).r), expected, 3e-3 * expected)
            << c.x << " " << c.z;
    }
}

TEST(RectangleLight, SamplesItsDensity) {
    const RectangleLight light({1, 0, 3}, {0, 1, 0}, {2, 0, 0}, Color(3.0f));
    const glm::dvec3 point(0.2, 0.4, 1.0);
    const auto density = [&](const glm::vec3& d) {
        trace::Ray ray;
        ray.origin = point;
        ray.direction = glm::normalize(glm::dvec3(d));
        const auto met = light.intersect(ray);
        return met ? double(met->pdf) : 0.0;
    };
    const auto draw = [&](const glm::vec2& u) -> std::optional<glm::vec3> { return light.sample(point, u)->direction; };
    EXPECT_LT(test::chiSquaredZ({0, 0, 1}, 1.2, draw, density, 200000, 5), 4.0);
}

TEST(RectangleLight, SamplesAndMeetingsAgree) {
    const RectangleLight light({1, 0, 3}, {0, 1, 0}, {2, 0, 0}, Color(3.0f));
    const glm::dvec3 point(0.2, 0.4, 1.0);
    double solid_angle = 0.0;
    for (int i = 0; i < 32; ++i) {
        for (int j = 0; j < 32; ++j) {
            const auto s = light.sample(point, {(i + 0.5f) / 32, (j + 0.5f) / 32});
            ASSERT_TRUE(s);
            trace::Ray ray;
            ray.origin = point;
            ray.direction = glm::normalize(glm::dvec3(s->direction));
            const auto met = light.intersect(ray);
            ASSERT_TRUE(met);
            EXPECT_NEAR(met->t, s->distance, 1e-5);
            EXPECT_NEAR(met->pdf, s->pdf, 1e-5f * s->pdf);
            solid_angle += 1.0 / double(s->pdf) / 1024.0;
        }
    }
    EXPECT_GT(solid_angle, 0.0);
    EXPECT_LT(solid_angle, 2.0 * std::numbers::pi);
    // From beside and away.
    EXPECT_FALSE(light.sample({0, 0, 3}, {0.5f, 0.5f}));
    trace::Ray away;
    away.origin = point;
    away.direction = {0, 0, -1};
    EXPECT_FALSE(light.intersect(away));
}

// Which half edge is named first is no way to say where a lamp shines.
TEST(RectangleLight, ShinesToBothSides) {
    const RectangleLight light({1, 0.5, 3}, {0, 1, 0}, {2, 0, 0}, Color(3.0f));
    for (const double side : {-1.0, 1.0}) {
        const glm::dvec3 point(0.2, 0.4, 3 + side);
        for (const glm::vec2 u : {glm::vec2(0.1f, 0.8f), glm::vec2(0.5f, 0.5f), glm::vec2(0.9f, 0.2f)}) {
            const auto s = light.sample(point, u);
            ASSERT_TRUE(s) << side;
            const glm::dvec3 met = point + s->distance * glm::dvec3(s->direction);
            EXPECT_NEAR(met.z, 3, 1e-6);
            EXPECT_LE(std::abs(met.x - 1), 2 + 1e-6);
            EXPECT_LE(std::abs(met.y - 0.5), 1 + 1e-6);
            trace::Ray ray;
            ray.origin = point;
            ray.direction = glm::normalize(glm::dvec3(s->direction));
            const auto hit = light.intersect(ray);
            ASSERT_TRUE(hit) << side;
            EXPECT_NEAR(hit->pdf, s->pdf, 1e-5f * s->pdf);
        }
    }
    EXPECT_FLOAT_EQ(light.sample({0.2, 0.4, 2}, {0.5f, 0.5f})->pdf, light.sample({0.2, 0.4, 4}, {0.5f, 0.5f})->pdf);
}

}  // namespace
}  // namespace stratum
