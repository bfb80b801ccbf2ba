#include "view/picture/jpeg.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace stratum::view {
namespace {

TEST(Jpeg, IsAJpeg) {
    const std::vector<std::uint8_t> rgb(3 * 33 * 17, 200);
    const std::vector<std::uint8_t> file = encodeJpeg(33, 17, rgb, 80);
    ASSERT_GT(file.size(), 100U);
    EXPECT_EQ(file[0], 0xff);
    EXPECT_EQ(file[1], 0xd8);
    EXPECT_EQ(file[file.size() - 1], 0xd9);
    EXPECT_THROW((void)encodeJpeg(33, 18, rgb, 80), std::invalid_argument);
    EXPECT_THROW((void)encodeJpeg(70000, 1, std::vector<std::uint8_t>(210000), 80), std::runtime_error);
}

}  // namespace
}  // namespace stratum::view
