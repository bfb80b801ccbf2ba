#include "shade/post/exposure.h"

#include "shade/analytic_prints.h"
#include "shade/integrator/bare_light.h"

#include <gtest/gtest.h>

#include <cmath>

namespace stratum {
namespace {

shade::SceneDescription sceneOf(const char* env, const std::vector<std::string>& lights = {}) {
    static const auto ball = test::sphere({0, 0, 1}, 1.0);
    shade::SceneOptions options;
    options.env = env;
    options.lights = lights;
    return shade::makeScene(options, ball, 64, 48);
}

TEST(BareLight, IsTheIrradianceOfTheLight) {
    const shade::BareLight even(sceneOf("constant:2,2,2"), {0, 0, 1});
    EXPECT_NEAR(even.brightest(), 2.0f, 0.01f);  // up; the bed returns less than it gets
    EXPECT_NEAR(even.matt({0, 0, 1}), 1.0f, 0.005f);
    EXPECT_NEAR(even.gloss({0, 0, 1}), 1.0f, 0.01f);
    EXPECT_LT(even.matt({0, 0, -1}), 0.95f);
    // A lamp from the right: by the cosine, and only where it shines.
    const shade::BareLight lamp(sceneOf("constant:0,0,0", {"directional:-1,0,0,3,3,3"}), {0, 0, 1});
    EXPECT_NEAR(lamp.brightest(), 3.0f / 3.14159f, 0.02f);
    for (const float degrees : {0.0f, 30.0f, 60.0f}) {
        const float a = degrees * 3.14159265f / 180.0f;
        EXPECT_NEAR(lamp.matt({std::cos(a), 0.0f, std::sin(a)}), std::cos(a), 0.03f) << degrees;
    }
    EXPECT_NEAR(lamp.matt({-1, 0, 0}), 0.0f, 0.01f);
}

TEST(Exposure, ComesFromTheLightAlone) {
    const glm::dvec3 place(0, 0, 1);
    const double one = shade::automaticExposure(sceneOf("constant:1,1,1"), place);
    EXPECT_NEAR(one, std::log2(1.3), 0.02);
    // Twice the light, a stop less.
    EXPECT_NEAR(shade::automaticExposure(sceneOf("constant:64,64,64"), place), one - 6.0, 1e-4);
    // Lamps count, and nothing at all is left alone.
    EXPECT_LT(shade::automaticExposure(sceneOf("constant:1,1,1", {"directional:0,0,-1,9,9,9"}), place), one - 1.0);
    EXPECT_EQ(shade::automaticExposure(sceneOf("constant:0,0,0"), place), 0.0);
    // A low sun: the walls that it shines on get more than the bed does.
    const double low = shade::automaticExposure(sceneOf("sky:10,120,3"), place);
    EXPECT_LT(low, shade::automaticExposure(sceneOf("sky:60,120,3"), place) - 0.5);
    EXPECT_TRUE(std::isfinite(low));
}

}  // namespace
}  // namespace stratum
