#include "trace/convex_solid.h"

#include "base/error.h"

#include <gtest/gtest.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace stratum::trace {
namespace {

/// Random rays against small steps through what `inside` says; the normals against the way out.
void checkAgainst(const Intersector& solid, const std::function<bool(const glm::dvec3&)>& inside) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> where(-6.0, 6.0);
    const auto point = [&] { return glm::dvec3(where(random), where(random), where(random)); };
    const auto tracer = solid.makeTracer();
    constexpr double kStep = 1e-3;
    int hits = 0;
    for (int n = 0; n < 3000; ++n) {
        Ray ray;
        ray.origin = point();
        ray.direction = glm::normalize(0.3 * point() - ray.origin);
        // Vertical and level rays are cases of their own.
        if (n % 10 == 0) ray.direction = {0, 0, n % 20 == 0 ? 1.0 : -1.0};
        if (n % 10 == 1) ray.direction = {n % 20 == 1 ? 1.0 : -1.0, 0, 0};
        const auto isIn = [&](double t) { return inside(ray.origin + t * ray.direction); };
        double brute = kInfinity;
        const bool from_inside = isIn(0.0);
        for (int step = 1; step < 20000 && brute == kInfinity; ++step)
            if (isIn(step * kStep) != from_inside) brute = step * kStep;
        Hit hit;
        const bool met = tracer->intersect(ray, hit);
        EXPECT_EQ(met, tracer->occluded(ray));
        // What is thinner than a step along the ray may be stepped over.
        if (met && brute == kInfinity) {
            EXPECT_FALSE(isIn(hit.t + 2 * kStep));
            continue;
        }
        ASSERT_EQ(met, brute < kInfinity) << n;
        if (!met) continue;
        ++hits;
        if (hit.t < brute - 1.001 * kStep) {
            EXPECT_FALSE(isIn(hit.t + 2 * kStep)) << n;
            continue;
        }
        EXPECT_LE(hit.t, brute + 1e-9) << n;
        EXPECT_NEAR(glm::length(hit.normal), 1.0, 1e-12);
        EXPECT_FALSE(inside(hit.position + 1e-6 * hit.normal)) << n;
        EXPECT_TRUE(inside(hit.position - 1e-6 * hit.normal) || std::abs(glm::dot(hit.normal, ray.direction)) < 0.05)
            << n;
        EXPECT_EQ(glm::dot(hit.normal, ray.direction) < 0.0, !from_inside) << n;
        // Before t_max only what is nearer.
        ray.t_max = 0.999 * hit.t;
        EXPECT_FALSE(tracer->occluded(ray));
        // A ray that leaves the surface meets a convex solid no more.
        Ray leaving;
        leaving.origin = hit.position + solid.surfaceOffset() * hit.normal;
        leaving.direction = hit.normal;
        EXPECT_FALSE(tracer->occluded(leaving)) << n;
    }
    EXPECT_GT(hits, 500);
}

TEST(ConvexSolid, ABoxIsABox) {
    const glm::dvec3 low(-1, -2, 0.5);
    const glm::dvec3 high(2, 1, 3);
    checkAgainst(*makeBoxSolid(low, high), [&](const glm::dvec3& p) {
        return p.x > low.x && p.y > low.y && p.z > low.z && p.x < high.x && p.y < high.y && p.z < high.z;
    });
}

TEST(ConvexSolid, AHexagonHasSixSides) {
    const auto hexagon = makeHexagonSolid(4, -1, 1.5);
    checkAgainst(*hexagon, [](const glm::dvec3& p) {
        const double u = 0.5 * p.x + std::sqrt(0.75) * p.y;
        const double v = -0.5 * p.x + std::sqrt(0.75) * p.y;
        return std::max({std::abs(p.x), std::abs(u), std::abs(v)}) < 2 && p.z > -1 && p.z < 1.5;
    });
    EXPECT_NEAR(hexagon->bounds().max.y, 4 / std::sqrt(3.0), 1e-12);
}

TEST(ConvexSolid, ConesOfAllSlopes) {
    for (const auto& [low_radius, high_radius] :
         {std::pair{0.5, 3.0}, {3.0, 0.5}, {2.0, 2.0}, {0.01, 4.0}, {2.0, 2.1}}) {
        const double low = -1.5;
        const double high = 2.0;
        const double r0 = low_radius;
        const double r1 = high_radius;
        checkAgainst(*makeConeSolid(low, r0, high, r1), [=](const glm::dvec3& p) {
            return p.z > low && p.z < high && std::hypot(p.x, p.y) < r0 + (r1 - r0) * (p.z - low) / (high - low);
        });
    }
}

TEST(ConvexSolid, ARayAlongTheSideOfACone) {
    // Slope 1: the ray is parallel to a line of the cone, so that the quadratic is none.
    const auto cone = makeConeSolid(0, 1, 3, 4);
    Ray ray;
    ray.origin = {0, 0, -2};
    ray.direction = glm::normalize(glm::dvec3(1, 0, 1));
    Hit hit;
    EXPECT_FALSE(cone->makeTracer()->intersect(ray, hit));
    ray.origin = {-3, 0, 1};
    ASSERT_TRUE(cone->makeTracer()->intersect(ray, hit));
    EXPECT_NEAR(hit.position.x, -2.5, 1e-12);
    EXPECT_NEAR(hit.position.z, 1.5, 1e-12);
}

TEST(ConvexSolid, RefusesWhatIsNone) {
    EXPECT_THROW((void)makeBoxSolid({0, 0, 0}, {1, 1, 0}), UsageError);
    EXPECT_THROW((void)makeSlabSolid({{{0, 0, 2}, 0, 1}}, {}), UsageError);
    EXPECT_THROW((void)makeConeSolid(0, 1, 0, 1), UsageError);
    EXPECT_THROW((void)makeConeSolid(0, 0, 1, 1), UsageError);
}

}  // namespace
}  // namespace stratum::trace
