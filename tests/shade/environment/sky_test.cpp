#include "shade/environment/studio_and_sky.h"

#include "shade/camera/sampling.h"
#include "shade/light/light.h"

#include <gtest/gtest.h>

#include <numbers>

namespace stratum {
namespace {

using shade::Color;

TEST(Sky, LightsASheetToTheStudiosLevel) {
    for (const double elevation : {0.1, 0.6, 1.2}) {
        for (const double turbidity : {2.0, 6.0}) {
            const auto sky = shade::makeSky({elevation, 1.0, turbidity});
            const Color e = sky->irradianceFromAbove() + shade::irradianceFrom(*sky->sun(), glm::dvec3(0.0));
            EXPECT_NEAR(shade::luminance(e) * shade::kInvPi, shade::kStudioLevel, 0.02f) << elevation;
        }
    }
}

TEST(Sky, IsBlueAboveAndTheSunIsWarm) {
    const auto sky = shade::makeSky({0.5, 0.0, 2.5});
    const Color up = sky->radiance({0, 0, 1});
    EXPECT_GT(up.b, 1.5f * up.r);
    const auto sun = sky->sun()->sample(glm::dvec3(0.0), {0.5f, 0.5f});
    ASSERT_TRUE(sun);
    EXPECT_GT(sun->light.r, sun->light.b);
    EXPECT_NEAR(sun->direction.z, std::sin(0.5f), 0.01f);
    EXPECT_GT(sun->direction.x, 0.8f);
    // Brighter near the sun than opposite to it.
    EXPECT_GT(shade::luminance(sky->radiance({0.8f, 0, 0.6f})), shade::luminance(sky->radiance({-0.8f, 0, 0.6f})));
}

TEST(Sky, IsFiniteForEveryDay) {
    for (const double elevation : {0.0175, 0.3, 1.0, 0.5 * std::numbers::pi}) {
        for (const double turbidity : {2.0, 8.0}) {
            const auto sky = shade::makeSky({elevation, 0.0, turbidity});
            for (int i = 0; i < 64; ++i) {
                const Color c = sky->radiance(shade::toSphere({(i % 8 + 0.5f) / 8, (i / 8 + 0.5f) / 8}));
                EXPECT_TRUE(shade::isFinite(c));
                EXPECT_GE(std::min({c.r, c.g, c.b}), 0.0f);
            }
            EXPECT_GT(shade::luminance(sky->irradianceFromAbove()), 0.0f);
        }
    }
}

}  // namespace
}  // namespace stratum
