#include "march/reference/reference_intersectors.h"

#include "base/error.h"
#include "march/brick/brick_intersector.h"
#include "random_rays.h"
#include "rubble.h"

#include <gtest/gtest.h>
#include <openvdb/tools/ChangeBackground.h>

#include <cmath>

namespace stratum::march {
namespace {

class Relaxation : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Plain_and_over, Relaxation, testing::Values(1.0, 1.4),
                         [](const auto& value) { return value.param > 1 ? "over" : "plain"; });

TEST_P(Relaxation, FindsAlmostAllThatIsThere) {
    const auto grid = test::rubble(0.1F, false);
    const auto exact = makeBrickIntersector(*grid);
    const auto intersector = makeSphereIntersector(grid, GetParam());
    const auto oracle = exact->makeTracer();
    const auto tracer = intersector->makeTracer();
    int hits = 0;
    int wrong = 0;
    double sum = 0;
    for (const trace::Ray& ray : test::randomRays(20000, 4, 0.1, 31)) {
        if (glm::length(ray.origin) > 1e5) continue;
        trace::Hit expected;
        trace::Hit hit;
        const bool there = oracle->intersect(ray, expected);
        const bool found = tracer->intersect(ray, hit);
        ASSERT_EQ(tracer->occluded(ray), found);
        if (there != found || (found && std::abs(hit.t - expected.t) > 0.05 * 0.1)) {
            ++wrong;
            continue;
        }
        if (!found) continue;
        ++hits;
        sum += std::abs(hit.t - expected.t) / 0.1;
        ASSERT_NEAR(glm::length(hit.normal), 1, 1e-9);
    }
    EXPECT_GT(hits, 5000);
    EXPECT_LT(wrong, hits / 100);
    EXPECT_LT(sum / hits, 2e-3);
}

TEST(SphereIntersector, StepsByTheLargestSlopeThatTheGridStates) {
    const auto grid = test::rubble(0.1F, false);
    const auto steep = grid->deepCopy();
    for (auto voxel = steep->beginValueAll(); voxel; ++voxel) voxel.setValue(10 * *voxel);
    openvdb::tools::changeBackground(steep->tree(), 10 * grid->background());
    const auto misses = [&](const openvdb::FloatGrid::ConstPtr& traced) {
        const auto exact = makeBrickIntersector(*grid);
        const auto oracle = exact->makeTracer();
        const auto intersector = makeSphereIntersector(traced, 1);
        const auto tracer = intersector->makeTracer();
        int wrong = 0;
        for (const trace::Ray& ray : test::randomRays(5000, 4, 0.1, 31))
            if (glm::length(ray.origin) < 1e5 && oracle->occluded(ray) != tracer->occluded(ray)) ++wrong;
        return wrong;
    };
    const int plain = misses(grid);
    EXPECT_GT(misses(steep), 10 * (plain + 1));
    steep->insertMeta("largest_slope", openvdb::DoubleMetadata(10));
    EXPECT_LE(misses(steep), 2 * plain + 5);
}

TEST(SphereIntersector, FarAndDegenerateRaysEnd) {
    const auto intersector = makeSphereIntersector(test::sphereGrid(3, openvdb::Vec3f(0), 0.1F));
    const auto tracer = intersector->makeTracer();
    for (const double away : {10.0, 1e6, 1e9}) {
        trace::Hit hit;
        ASSERT_TRUE(tracer->intersect({{0, 0.3, away}, {0, 0, -1}}, hit));
        EXPECT_NEAR(hit.position.z, std::sqrt(9 - 0.09), 1e-2);
        EXPECT_FALSE(tracer->occluded({{5, 0.3, away}, {0, 0, -1}}));
        EXPECT_TRUE(tracer->occluded({{1e-3, 0, away}, glm::normalize(glm::dvec3(0, 0, -1))}));
    }
    // Ten voxels are less than the rounding of such a place.
    EXPECT_FALSE(
        tracer->occluded({{1e40, 1e40, 1e40}, {-std::sqrt(1.0 / 3), -std::sqrt(1.0 / 3), -std::sqrt(1.0 / 3)}}));
    EXPECT_FALSE(tracer->occluded({{std::nan(""), 0, 9}, {0, 0, -1}}));
    EXPECT_FALSE(tracer->occluded({{0, 0, 9}, {0, std::nan(""), -1}}));
}

TEST(SphereIntersector, RefusesWhatItCannotTrace) {
    EXPECT_THROW(makeSphereIntersector(openvdb::FloatGrid::create(1.0F)), InputError);
}

}  // namespace
}  // namespace stratum::march
