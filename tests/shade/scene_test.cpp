#include "shade/scene.h"

#include "io/error.h"
#include "shade/analytic_prints.h"

#include <gtest/gtest.h>

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
}

}  // namespace
}  // namespace stratum
