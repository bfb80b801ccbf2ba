#include "shade/measured/scan_text.h"

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

}  // namespace
}  // namespace stratum
