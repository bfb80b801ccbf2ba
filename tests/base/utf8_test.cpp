#include "base/utf8.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

TEST(Utf8, TellsItFromOtherBytes) {
    for (const char* text : {"", "plain", "caf\xc3\xa9", "\xe2\x82\xac", "\xf0\x9f\x98\x80"}) EXPECT_TRUE(isUtf8(text));
    // A lone byte, a short form, a surrogate, beyond the last character, a cut one.
    for (const char* text : {"\xe9", "\xc0\xaf", "\xe0\x80\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xe2\x82"})
        EXPECT_FALSE(isUtf8(text)) << text;
}

TEST(Utf8, OtherBytesAreLatin1) {
    EXPECT_EQ(utf8Text("caf\xe9"), "caf\xc3\xa9");
    EXPECT_EQ(utf8Text("caf\xc3\xa9"), "caf\xc3\xa9");
}

}  // namespace
}  // namespace stratum
