#include "march/wide_intersector.h"

#include "march/brick_intersector.h"
#include "random_rays.h"

#include <openvdb/tools/LevelSetSphere.h>

#include <gtest/gtest.h>

#include <cmath>

namespace stratum::march {
namespace {

constexpr double kRadius = 5;

std::shared_ptr<const Intersector> ball(double voxel, double radius) {
    openvdb::initialize();
    return makeBrickIntersector(*openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(
        static_cast<float>(radius), openvdb::Vec3f(0.1F, 0.2F, 0.3F), static_cast<float>(voxel)));
}

struct Both {
    std::shared_ptr<const Intersector> fine = ball(0.1, kRadius);
    // Larger, so that some rays meet the wall where it begins.
    std::shared_ptr<const Intersector> coarse = ball(0.4, kRadius + 0.05);
    double distance = 3.2;
    std::shared_ptr<const Intersector> wide = makeWideIntersector(fine, coarse, distance);
};

const Both& both() {
    static const Both the_both;
    return the_both;
}

TEST(WideIntersector, IsTheFineOneForOtherRays) {
    const auto fine = both().fine->makeTracer();
    const auto wide = both().wide->makeTracer();
    const std::vector<Ray> rays = test::randomRays(4000, 8, 0.1, 5);
    std::vector<Hit> expected(rays.size());
    std::vector<Hit> found(rays.size());
    std::vector<std::uint8_t> blocked(rays.size());
    fine->intersectStream(rays, expected);
    wide->intersectStream(rays, found);
    wide->occludedStream(rays, blocked);
    for (std::size_t n = 0; n < rays.size(); ++n) {
        ASSERT_EQ(found[n].t, expected[n].t);
        ASSERT_EQ(blocked[n] != 0, std::isfinite(expected[n].t));
        if (!std::isfinite(found[n].t)) continue;
        ASSERT_EQ(found[n].normal, expected[n].normal);
        ASSERT_EQ(found[n].part, 0U);
    }
    EXPECT_EQ(both().wide->bounds().min, both().fine->bounds().min);
    EXPECT_EQ(both().wide->voxelSize(), both().fine->voxelSize());
    EXPECT_EQ(both().wide->surfaceOffset(), both().fine->surfaceOffset());
}

// Near hits are the fine one's, far ones the coarse one's, and where one hands on to the other there is no gap: a ray
// that goes deep is met, and met no deeper than both are off.
TEST(WideIntersector, IsTheCoarseOneForWideRaysFarAway) {
    const auto fine = both().fine->makeTracer();
    const auto coarse = both().coarse->makeTracer();
    const auto wide = both().wide->makeTracer();
    const glm::dvec3 centre(0.1, 0.2, 0.3);
    constexpr double kOff = 0.06;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> away(kRadius + 0.001, kRadius + 7);
    std::vector<Ray> rays;
    for (int n = 0; n < 30000; ++n) {
        Ray ray;
        ray.wide = true;
        ray.origin = centre + away(random) * test::randomDirection(random);
        // Half of them to where one hands on to the other lies at the surface.
        const glm::dvec3 target = centre + kRadius * test::randomDirection(random);
        ray.direction = glm::normalize(target - ray.origin);
        if (n % 2 == 0) ray.origin = target - (both().distance + 0.04 * (n % 7 - 3) / 3) * ray.direction;
        rays.push_back(ray);
    }
    std::vector<Hit> stream(rays.size());
    wide->intersectStream(rays, stream);
    std::size_t near = 0;
    std::size_t far = 0;
    std::size_t walls = 0;
    for (std::size_t n = 0; n < rays.size(); ++n) {
        const Ray& ray = rays[n];
        if (glm::length(ray.origin - centre) < kRadius + kOff) continue;
        Hit found;
        const bool any = wide->intersect(ray, found);
        ASSERT_EQ(std::isfinite(stream[n].t), any);
        const double miss = glm::length(glm::cross(centre - ray.origin, ray.direction));
        if (miss < kRadius - kOff && glm::dot(centre - ray.origin, ray.direction) > 0) {
            ASSERT_TRUE(any);
        }
        if (!any) continue;
        ASSERT_EQ(stream[n].t, found.t);
        ASSERT_EQ(stream[n].part, found.part);
        EXPECT_NEAR(glm::length(found.position - centre), kRadius, kOff);
        EXPECT_LE(glm::dot(found.normal, ray.direction), 1e-9);
        Hit own;
        if (found.part == 0) {
            ++near;
            EXPECT_LE(found.t, both().distance);
            ASSERT_TRUE(fine->intersect(ray, own));
            ASSERT_NEAR(own.t, found.t, 1e-12);
            continue;
        }
        ASSERT_TRUE(coarse->intersect(ray, own));
        ASSERT_NEAR(own.t, found.t, 1e-9);
        ++(found.t < both().distance ? walls : far);
    }
    EXPECT_GT(near, 1000U);
    EXPECT_GT(far, 1000U);
    EXPECT_GT(walls, 20U);
}

}  // namespace
}  // namespace stratum::march
