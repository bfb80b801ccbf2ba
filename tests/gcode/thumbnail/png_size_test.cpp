#include "gcode/thumbnail/thumbnail.h"

#include <gtest/gtest.h>

namespace stratum::gcode {
namespace {

using namespace std::string_view_literals;

TEST(PngSize, StandsInTheFirstChunk) {
    EXPECT_EQ(pngSize("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\1\x2c\0\0\0\x10 and more"sv),
              (ThumbnailSize{300, 16, ThumbnailCoding::png}));
}

TEST(PngSize, NothingOfOtherBytes) {
    EXPECT_EQ(pngSize(""), std::nullopt);
    EXPECT_EQ(pngSize("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\1\x2c\0\0\0"sv), std::nullopt);
    EXPECT_EQ(pngSize("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\0\0\0\0\x10"sv), std::nullopt);
    EXPECT_EQ(pngSize("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\x7f\0\0\0\0\0\0\x10"sv), std::nullopt);
    EXPECT_EQ(pngSize("BM0000000000000000000000000000"), std::nullopt);
}

}  // namespace
}  // namespace stratum::gcode
