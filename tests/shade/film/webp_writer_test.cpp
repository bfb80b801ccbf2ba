#include "shade/film/lossy_writers.h"

#include "shade/film/gradient.h"

#include <gtest/gtest.h>
#include <webp/decode.h>

#include <cstddef>
#include <memory>
#include <stdexcept>

namespace stratum::shade {
namespace {

TEST(Webp, IsThePicture) {
    const std::vector<std::uint8_t> rgb = test::gradient(133, 77);
    const std::vector<std::uint8_t> file = encodeWebp(133, 77, rgb, 90);
    int width = 0;
    int height = 0;
    const std::unique_ptr<std::uint8_t, decltype(&WebPFree)> back(
        WebPDecodeRGB(file.data(), file.size(), &width, &height), &WebPFree);
    ASSERT_NE(back, nullptr);
    EXPECT_EQ(width, 133);
    EXPECT_EQ(height, 77);
    EXPECT_LT(test::meanDifference(rgb, {back.get(), back.get() + rgb.size()}), 1.5);
}

TEST(Webp, RefusesWhatIsNoPicture) {
    EXPECT_THROW((void)encodeWebp(33, 18, std::vector<std::uint8_t>(7), 80), std::invalid_argument);
    EXPECT_THROW((void)encodeWebp(kWebpMostSide + 1, 1, std::vector<std::uint8_t>(3 * (kWebpMostSide + 1)), 80),
                 std::runtime_error);
}

}  // namespace
}  // namespace stratum::shade
