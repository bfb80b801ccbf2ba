#include "gcode/thumbnail/thumbnail.h"

#include "base/error.h"
#include "refusal.h"

#include <gtest/gtest.h>

namespace stratum::gcode {
namespace {

std::string thumbnailError(std::string_view text) {
    return test::messageOf<UsageError>([&] { (void)parseThumbnails(text); }, "no error");
}

TEST(Thumbnail, SizesAndKinds) {
    const std::vector<ThumbnailSize> expected{{300, 300, ThumbnailCoding::png},
                                              {16, 16, ThumbnailCoding::qoi},
                                              {220, 124, ThumbnailCoding::jpg},
                                              {4096, 1, ThumbnailCoding::png}};
    EXPECT_EQ(parseThumbnails("300x300,16x16/QOI, 220X124/jpeg,4096x1/png"), expected);
}

TEST(Thumbnail, WhatIsNone) {
    EXPECT_NE(thumbnailError("").find("expected WIDTHxHEIGHT"), std::string::npos);
    EXPECT_NE(thumbnailError("300").find("expected WIDTHxHEIGHT"), std::string::npos);
    EXPECT_NE(thumbnailError("300x").find("expected WIDTHxHEIGHT"), std::string::npos);
    EXPECT_NE(thumbnailError("300x300x3").find("expected WIDTHxHEIGHT"), std::string::npos);
    EXPECT_NE(thumbnailError("-3x300").find("expected WIDTHxHEIGHT"), std::string::npos);
    EXPECT_NE(thumbnailError("300x300,").find("expected WIDTHxHEIGHT"), std::string::npos);
    EXPECT_NE(thumbnailError("0x16").find("from 1 to 4096"), std::string::npos);
    EXPECT_NE(thumbnailError("16x4097").find("from 1 to 4096"), std::string::npos);
    EXPECT_NE(thumbnailError("16x99999999999999999999").find("from 1 to 4096"), std::string::npos);
    EXPECT_NE(thumbnailError("16x16/PMG").find("did you mean 'PNG'"), std::string::npos);
    EXPECT_NE(thumbnailError("16x16/").find("is no kind of picture"), std::string::npos);
    EXPECT_NE(thumbnailError("16x16,16x16/PNG").find("twice"), std::string::npos);
    std::string many = "1x1";
    for (int n = 2; n < 19; ++n) many += ",1x" + std::to_string(n);
    EXPECT_NE(thumbnailError(many).find("at most 16"), std::string::npos);
}

}  // namespace
}  // namespace stratum::gcode
