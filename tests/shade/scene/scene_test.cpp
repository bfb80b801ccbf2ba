#include "shade/scene/scene.h"

#include "base/error.h"
#include "shade/analytic_prints.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

namespace stratum {
namespace {

using shade::makeScene;

TEST(MakeScene, PutsTheBedUnderTheSurfaceNotUnderItsBand) {
    const test::Vase vase;
    const auto print = vase.intersector();  // its box begins 0.3 below the surface
    const auto scene = makeScene({}, print, 64, 48);
    ASSERT_TRUE(scene.bed);
    EXPECT_NEAR(scene.bed->z, 0.0, 1e-3);
    EXPECT_TRUE(scene.backdrop);
    EXPECT_EQ(shade::restingHeight(test::nothing(2.0)), -2.0);
}

// A ball without voxels, far above the floor of its box; counts the rays that it is asked.
TEST(MakeScene, FindsTheBedInFewStepsWithoutVoxels) {
    class NoVoxels final : public test::FunctionIntersector {
    public:
        using FunctionIntersector::FunctionIntersector;
        double voxelSize() const override { return 0.0; }
    };
    std::atomic<int> asked{0};
    const auto ball = test::sphere({0, 0, 5}, 5.0);
    const NoVoxels high({{-5, -5, -300}, {5, 5, 10}}, 1e-6, [&](const trace::Ray& ray, trace::Hit& hit) {
        ++asked;
        return ball.makeTracer()->intersect(ray, hit);
    });
    EXPECT_NEAR(shade::restingHeight(high), 0.0, 1e-3);
    EXPECT_LE(asked.load(), 32 * 32 + 5 * 128 * 128);
    const NoVoxels empty({{-5, -5, 0}, {5, 5, 0}}, 1e-6, [](const trace::Ray&, trace::Hit&) { return false; });
    EXPECT_EQ(shade::restingHeight(empty), 0.0);
}

// A plate with a foot of 0.5 mm that a ray in 16 000 meets; counts the rays that it is asked.
TEST(MakeScene, FewRaysFindWhatRestsOnItsBoxAndMoreASmallFoot) {
    std::atomic<int> asked{0};
    const auto plate = [&asked](double floor, double foot) {
        return test::FunctionIntersector(
            {{-32, -32, floor}, {32, 32, 40}}, 1e-6, [&asked, foot](const trace::Ray& ray, trace::Hit& hit) {
                ++asked;
                const bool at_foot = std::abs(ray.origin.x - 8.75) < 0.25 && std::abs(ray.origin.y + 3.25) < 0.25;
                hit.position = ray.origin;
                hit.position.z = at_foot ? foot : 0.0;
                hit.t = hit.position.z - ray.origin.z;
                return hit.t <= ray.t_max;
            });
    };
    EXPECT_EQ(shade::restingHeight(plate(-0.3, 0.0)), 0.0);  // a band of three voxels
    EXPECT_EQ(asked.exchange(0), 32 * 32);
    EXPECT_EQ(shade::restingHeight(plate(-0.8, -0.5)), -0.5);
    EXPECT_EQ(asked.load(), 32 * 32 + 128 * 128);
}

TEST(MakeScene, NoBedFromBelowOrOnDemand) {
    const auto ball = test::sphere({0, 0, 5}, 5.0);
    shade::SceneOptions options;
    options.camera.view = shade::View::bottom;
    const auto below = makeScene(options, ball, 64, 48);
    EXPECT_FALSE(below.bed);
    EXPECT_GT(below.environment->radiance({0, 0, -1}).r, 0.0f);
    options = {};
    options.bed = false;
    EXPECT_FALSE(makeScene(options, ball, 64, 48).bed);
    EXPECT_TRUE(makeScene(options, ball, 64, 48).backdrop);
    options.backdrop = false;
    EXPECT_FALSE(makeScene(options, ball, 64, 48).backdrop);
    options.env = "constant:1,1,1";
    options.backdrop = true;
    EXPECT_FALSE(makeScene(options, ball, 64, 48).backdrop);  // a sky is its own backdrop
}

TEST(MakeScene, PassesErrorsOn) {
    const auto ball = test::sphere({0, 0, 5}, 5.0);
    shade::SceneOptions options;
    options.lights = {"lamp"};
    EXPECT_THROW(makeScene(options, ball, 64, 48), UsageError);
    options.lights.assign(1025, "point:0,0,9,1,1,1");
    EXPECT_THROW(makeScene(options, ball, 64, 48), UsageError);
}

}  // namespace
}  // namespace stratum
