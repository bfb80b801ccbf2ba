#include "shade/measured/scan_channels.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

TEST(ScanChannels, ChoosesTheNearestWavelengths) {
    const auto three = shade::chooseChannels({465, 525, 630});
    EXPECT_EQ(three.red, 2u);
    EXPECT_EQ(three.green, 1u);
    EXPECT_EQ(three.blue, 0u);
    const auto one = shade::chooseChannels({550});
    EXPECT_EQ(one.red, 0u);
    EXPECT_EQ(one.blue, 0u);
}

TEST(ScanChannels, WhiteIsWhite) {
    const auto white = shade::fromXyz(0.9505, 1.0, 1.089);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(white[c], 1.0f, 1e-3f);
}

}  // namespace
}  // namespace stratum
