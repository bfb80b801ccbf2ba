#include "base/srgb.h"

#include <gtest/gtest.h>

#include <cmath>

namespace stratum {
namespace {

TEST(Srgb, EveryByteComesBack) {
    EXPECT_NEAR(linearOfSrgb(0.5), 0.21404, 1e-5);
    EXPECT_EQ(linearOfSrgb(0), 0);
    EXPECT_NEAR(linearOfSrgb(1), 1, 1e-15);
    for (int n = 0; n < 256; ++n) {
        EXPECT_EQ(std::lround(255 * srgbOfLinear(linearOfSrgb(n / 255.0))), n);
        EXPECT_EQ(std::lround(255 * srgbOfLinear(static_cast<float>(linearOfSrgb(n / 255.0)))), n);
    }
}

}  // namespace
}  // namespace stratum
