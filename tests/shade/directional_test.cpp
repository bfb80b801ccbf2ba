#include "shade/directional.h"

#include "io/error.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

TEST(DirectionalLight, ReadsTheWayTheLightTravels) {
    const auto light = shade::parseDirectionalLight("directional:0,0,-2,1,2,3");
    EXPECT_EQ(light.to_light, glm::vec3(0, 0, 1));
    EXPECT_EQ(light.irradiance, shade::Color(1, 2, 3));
}

TEST(DirectionalLight, RefusesNonsense) {
    for (const char* text : {"", "sun", "directional:1,2,3", "directional:0,0,0,1,1,1", "directional:0,0,1,-1,0,0"})
        EXPECT_THROW(shade::parseDirectionalLight(text), UsageError) << text;
}

}  // namespace
}  // namespace stratum
