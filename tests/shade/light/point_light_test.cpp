#include "shade/light/light.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

TEST(PointLight, FallsWithTheSquareOfDistance) {
    const shade::PointLight light({1, 2, 3}, shade::Color(8, 4, 2));
    const auto s = light.sample({1, 2, 1}, {});
    ASSERT_TRUE(s);
    EXPECT_EQ(s->direction, glm::vec3(0, 0, 1));
    EXPECT_EQ(s->distance, 2.0);
    EXPECT_EQ(s->light, shade::Color(2, 1, 0.5));
    EXPECT_FALSE(light.sample({1, 2, 3}, {}));
    EXPECT_FALSE(light.sample({1, 2, 3 + 1e-30}, {}));
}

}  // namespace
}  // namespace stratum
