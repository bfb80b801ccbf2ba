#include "march/brick/brick_intersector.h"

#include "base/error.h"
#include "brute_march.h"
#include "random_rays.h"
#include "refusal.h"
#include "rubble.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <chrono>
#include <cmath>
#include <random>

namespace stratum::march {
namespace {

using test::randomDirection;
using test::rubble;

struct Tally {
    int hits = 0, misses = 0, wrong = 0;
    double farthest = 0;
};

Tally compare(const openvdb::FloatGrid& grid, int rays, std::uint32_t seed, BrickValues values) {
    const auto intersector = makeBrickIntersector(grid, values);
    const auto tracer = intersector->makeTracer();
    // Bricks of 16 bits are exact, too, for what they hold.
    const auto held = test::quantized(grid);
    test::BruteMarch brute(values == BrickValues::Int16 ? *held : grid);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> where(-4, 4);
    Tally tally;
    for (int n = 0; n < rays; ++n) {
        trace::Ray ray;
        ray.origin =
            n % 3 == 0 ? glm::dvec3(where(random), where(random), where(random)) : 20.0 * randomDirection(random);
        ray.direction = glm::normalize(glm::dvec3(where(random), where(random), where(random)) - ray.origin);
        if (n % 7 == 0) ray.t_min = 0.5 * glm::length(ray.origin);
        if (n % 11 == 0) ray.t_max = glm::length(ray.origin);
        const auto expected = brute(ray);
        trace::Hit hit;
        const bool found = tracer->intersect(ray, hit);
        EXPECT_EQ(tracer->occluded(ray), found);
        if (found != expected.has_value() || (found && std::abs(hit.t - *expected) > 1e-4 * grid.voxelSize()[0])) {
            ++tally.wrong;
            continue;
        }
        found ? ++tally.hits : ++tally.misses;
        if (!found) continue;
        tally.farthest = std::max(tally.farthest, std::abs(hit.t - *expected));
        EXPECT_NEAR(glm::length(hit.normal), 1, 1e-12);
    }
    return tally;
}

TEST(BrickIntersector, AgreesWithTheBruteMarch) {
    for (const BrickValues values : {BrickValues::Float32, BrickValues::Int16}) {
        const Tally tally = compare(*rubble(0.1F, false), 30000, 1, values);
        EXPECT_EQ(tally.wrong, 0);
        EXPECT_GT(tally.hits, 8000);
        EXPECT_GT(tally.misses, 1000);
        // The brute march of rounded samples has them rounded to floats once more, of which tangents make more.
        EXPECT_LT(tally.farthest, values == BrickValues::Float32 ? 1e-9 : 1e-5);
    }
}

TEST(BrickIntersector, FindsTheFirstOfSeveralCrossingsInACell) {
    // The brute march may itself miss a pair of crossings closer than a 200th of a chord; a handful is allowed.
    const Tally tally = compare(*rubble(0.15F, true), 30000, 2, BrickValues::Float32);
    EXPECT_LE(tally.wrong, 3);
    EXPECT_GT(tally.hits, 8000);
}

TEST(BrickIntersector, KeepsToTheIntervalOfTheRay) {
    const auto intersector = makeBrickIntersector(*test::sphereGrid(10, openvdb::Vec3f(3, -2, 5), 0.2F));
    const auto tracer = intersector->makeTracer();
    trace::Ray ray{{3, -2, 35}, {0, 0, -1}};
    trace::Hit hit;
    ASSERT_TRUE(tracer->intersect(ray, hit));
    EXPECT_NEAR(hit.t, 20, 1e-3);
    EXPECT_NEAR(hit.normal.z, 1, 1e-3);
    ray.t_max = 19.9;
    EXPECT_FALSE(tracer->occluded(ray));
    ray.t_max = 20.1;
    EXPECT_TRUE(tracer->occluded(ray));
    ray.t_min = 20.1;
    ray.t_max = std::numeric_limits<double>::infinity();
    ASSERT_TRUE(tracer->intersect(ray, hit));
    EXPECT_NEAR(hit.t, 40, 1e-3);
    ray.t_min = 40.1;
    EXPECT_FALSE(tracer->intersect(ray, hit));
}

TEST(BrickIntersector, NothingLeaksOutOfAClosedBody) {
    const auto grid = rubble(0.1F, false);
    const auto intersector = makeBrickIntersector(*grid);
    const auto tracer = intersector->makeTracer();
    std::mt19937 random(9);
    for (int n = 0; n < 300000; ++n) {
        trace::Ray ray;
        ray.origin = {0.3 * std::sin(n), 0.3 * std::cos(3.0 * n), 0.2 * std::sin(5.0 * n)};
        ray.direction = randomDirection(random);
        ASSERT_TRUE(tracer->occluded(ray)) << n;
    }
}

TEST(BrickIntersector, RaysAlongPlanesEdgesAndAxesEnd) {
    const auto grid = test::sphereGrid(3, openvdb::Vec3f(0), 0.1F);
    const auto intersector = makeBrickIntersector(*grid);
    const auto tracer = intersector->makeTracer();
    std::mt19937 random(3);
    std::uniform_int_distribution<int> lattice(-35, 35);
    const auto start = std::chrono::steady_clock::now();
    for (int n = 0; n < 200000; ++n) {
        // Origins on lattice points, far away or near; directions with zero, tiny or negative-zero components.
        trace::Ray ray;
        ray.origin = 0.1 * glm::dvec3(lattice(random), lattice(random), lattice(random));
        glm::dvec3 d(0.0);
        d[n % 3] = n % 2 == 0 ? 1 : -1;
        if (n % 5 == 0) d[(n + 1) % 3] = -0.0;
        if (n % 7 == 0) d[(n + 1) % 3] = 1e-7;
        if (n % 11 == 0) d[(n + 2) % 3] = d[n % 3];
        ray.direction = glm::normalize(d);
        if (n % 13 == 0) ray.origin -= 1e6 * ray.direction;
        trace::Hit hit;
        if (tracer->intersect(ray, hit)) {
            ASSERT_TRUE(std::isfinite(hit.t));
            ASSERT_TRUE(std::isfinite(hit.normal.x + hit.normal.y + hit.normal.z));
            ASSERT_NEAR(glm::length(hit.position), 3, 1e-2);
        }
    }
    EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 20.0);
}

TEST(BrickIntersector, SecondaryRaysDoNotMeetWhatTheyLeave) {
    const auto intersector = makeBrickIntersector(*test::sphereGrid(10, openvdb::Vec3f(0), 0.2F));
    const auto tracer = intersector->makeTracer();
    std::mt19937 random(2);
    int met = 0;
    constexpr int kRays = 100000;
    for (int n = 0; n < kRays; ++n) {
        trace::Ray ray;
        ray.origin = 40.0 * randomDirection(random);
        ray.direction = glm::normalize(6.0 * randomDirection(random) - ray.origin);
        trace::Hit hit;
        ASSERT_TRUE(tracer->intersect(ray, hit));
        ray.origin = hit.position + intersector->surfaceOffset() * hit.normal;
        ray.direction = glm::normalize(hit.normal + 0.95 * randomDirection(random));
        met += tracer->occluded(ray) ? 1 : 0;
    }
    EXPECT_EQ(met, 0);
}

TEST(BrickIntersector, FollowsTheTransform) {
    const auto grid = test::sphereGrid(10, openvdb::Vec3f(0), 0.2F);
    grid->transform().postRotate(0.7, openvdb::math::X_AXIS);
    grid->transform().postTranslate(openvdb::Vec3d(1000, 2000, 3000));
    const auto intersector = makeBrickIntersector(*grid);
    const auto tracer = intersector->makeTracer();
    std::mt19937 random(6);
    for (int n = 0; n < 2000; ++n) {
        const glm::dvec3 direction = randomDirection(random);
        const glm::dvec3 center(1000, 2000, 3000);
        trace::Hit hit;
        ASSERT_TRUE(tracer->intersect({center - 50.0 * direction, direction}, hit));
        EXPECT_NEAR(hit.t, 40, 2e-3);
        EXPECT_LT(glm::dot(hit.normal, direction), -0.999);
        EXPECT_NEAR(glm::length(hit.position - center), 10, 2e-3);
    }
}

TEST(BrickIntersector, EmptySpaceBetweenFarPartsIsCrossed) {
    auto grid = test::sphereGrid(1, openvdb::Vec3f(0), 0.1F);
    openvdb::tools::csgUnion(*grid, *test::sphereGrid(1, openvdb::Vec3f(60, 45, -30), 0.1F));
    const auto intersector = makeBrickIntersector(*grid);
    const auto tracer = intersector->makeTracer();
    const glm::dvec3 way = glm::normalize(glm::dvec3(60, 45, -30));
    trace::Hit hit;
    ASSERT_TRUE(tracer->intersect({1.5 * way, way}, hit));
    EXPECT_NEAR(hit.t, std::sqrt(60.0 * 60 + 45 * 45 + 30 * 30) - 2.5, 1e-2);
    EXPECT_FALSE(tracer->occluded({1.5 * way, glm::normalize(glm::dvec3(60, 47, -30))}));
}

TEST(BrickIntersector, RefusesWhatItCannotTrace) {
    EXPECT_THROW(makeBrickIntersector(*openvdb::FloatGrid::create(1.0F)), InputError);
    const auto fog = test::sphereGrid(2, openvdb::Vec3f(0), 0.2F);
    fog->setGridClass(openvdb::GRID_FOG_VOLUME);
    EXPECT_THROW(makeBrickIntersector(*fog), InputError);
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        const auto grid = test::sphereGrid(2, openvdb::Vec3f(0), 0.2F);
        grid->tree().setValue(openvdb::Coord(10, 1, 2), bad);
        EXPECT_TRUE(test::refuses<InputError>("(8, 0, 0)", [&] { makeBrickIntersector(*grid); })) << "traced " << bad;
    }
    const auto sheared = test::sphereGrid(1, openvdb::Vec3f(0), 0.1F);
    sheared->transform().preShear(0.2, openvdb::math::X_AXIS, openvdb::math::Y_AXIS);
    EXPECT_THROW(makeBrickIntersector(*sheared), InputError);
    auto apart = test::sphereGrid(1, openvdb::Vec3f(0), 0.1F);
    apart->tree().touchLeaf(openvdb::Coord(1 << 29, 1 << 29, 1 << 29));
    EXPECT_THROW(makeBrickIntersector(*apart), InputError);
}

}  // namespace
}  // namespace stratum::march
