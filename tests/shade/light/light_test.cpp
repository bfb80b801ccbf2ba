#include "shade/light/light.h"

#include "base/error.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

namespace stratum {
namespace {

using shade::Color;
using shade::parseLight;

TEST(ParseLight, DirectionalReadsTheWayTheLightTravels) {
    const auto s = parseLight("directional:0,0,-2,1,2,3")->sample(glm::dvec3(5.0), {0.2f, 0.7f});
    ASSERT_TRUE(s);
    EXPECT_EQ(s->direction, glm::vec3(0, 0, 1));
    EXPECT_EQ(s->light, Color(1, 2, 3));
    EXPECT_EQ(s->pdf, 0.0f);
}

TEST(ParseLight, EveryKindLightsASheet) {
    const auto lit = [](const char* text) { return shade::irradianceFrom(*parseLight(text), glm::dvec3(0.0)).r; };
    EXPECT_FLOAT_EQ(lit("directional:0,3,-4,5,5,5"), 4.0f);
    EXPECT_NEAR(lit("sun:0,3,-4,5,5,5"), 4.0f, 1e-3f);
    EXPECT_NEAR(lit("sun:0,0,-1,5,5,5,60"), 5.0f, 1e-2f);
    EXPECT_FLOAT_EQ(lit("point:0,0,2,12,12,12"), 3.0f);
    EXPECT_GT(lit("rectangle:0,0,10,1,0,0,0,-1,0,5,5,5"), 0.0f);
    EXPECT_EQ(lit("rectangle:0,0,10,1,0,0,0,1,0,5,5,5"), lit("rectangle:0,0,10,1,0,0,0,-1,0,5,5,5"));
    EXPECT_EQ(lit("point:0,0,-2,12,12,12"), 0.0f);
}

TEST(ParseLight, RefusesNonsense) {
    for (const char* text : {"", "lamp", "directional:1,2,3", "directional:0,0,0,1,1,1", "directional:0,0,1,-1,0,0",
                             "sun:0,0,1,1,1,1,0", "sun:0,0,1,1,1,1,120", "point:1,2,3", "point:0,0,0,1,1,nan",
                             "rectangle:0,0,0,1,0,0,1,0,0,1,1,1", "rectangle:0,0,0,0,0,0,0,1,0,1,1,1"})
        EXPECT_THROW(parseLight(text), UsageError) << text;
}

TEST(ParseAmbient, IsOneOfItsKind) {
    EXPECT_EQ(shade::parseAmbient("ambient:1,2,3"), Color(1, 2, 3));
    EXPECT_FALSE(shade::parseAmbient("point:1,2,3,4,5,6"));
    EXPECT_THROW(shade::parseAmbient("ambient:1"), UsageError);
}

}  // namespace
}  // namespace stratum
