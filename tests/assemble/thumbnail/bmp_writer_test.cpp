#include "assemble/thumbnail/bmp_and_qoi.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace stratum::assemble {
namespace {

TEST(Bmp, RowsFromBelowInBlueGreenRed) {
    const std::string file = encodeBmp(2, 2, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12});
    ASSERT_EQ(file.size(), 54U + 16U);
    EXPECT_EQ(file.substr(0, 2), "BM");
    EXPECT_EQ(file[2], 70);
    EXPECT_EQ(file[10], 54);
    EXPECT_EQ(file[14], 40);
    EXPECT_EQ(file[18], 2);
    EXPECT_EQ(file[28], 24);
    EXPECT_EQ(file.substr(54), std::string("\x9\x8\x7\xc\xb\xa\0\0\3\2\1\6\5\4\0\0", 16));
}

TEST(Bmp, AsLongAsFlashPrints) { EXPECT_EQ(encodeBmp(80, 60, std::vector<std::uint8_t>(80 * 60 * 3)).size(), 14454U); }

TEST(Bmp, RefusesWhatIsNoPicture) {
    EXPECT_THROW((void)encodeBmp(2, 2, std::vector<std::uint8_t>(11)), std::invalid_argument);
}

}  // namespace
}  // namespace stratum::assemble
