#include "base/base64.h"

#include <gtest/gtest.h>

#include <string>

namespace stratum {
namespace {

TEST(Base64, IsThatOfTheStandard) {
    EXPECT_EQ(base64Of(""), "");
    EXPECT_EQ(base64Of("f"), "Zg==");
    EXPECT_EQ(base64Of("fo"), "Zm8=");
    EXPECT_EQ(base64Of("foo"), "Zm9v");
    EXPECT_EQ(base64Of(std::string("\0\xff", 2)), "AP8=");
    EXPECT_EQ(base64Of("\xff\xfe\xfd"), "//79");
}

TEST(Base64, IsReadWithoutItsPadding) {
    EXPECT_EQ(bytesOfBase64("Zm9v"), "foo");
    EXPECT_EQ(bytesOfBase64(" Zm8 ").substr(0, 2), "fo");
    EXPECT_EQ(bytesOfBase64("Z*"), "");
}

}  // namespace
}  // namespace stratum
