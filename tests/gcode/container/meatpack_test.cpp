#include "gcode/container/unpack.h"

#include "gcode/container_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace stratum::gcode {
namespace {

using namespace std::string_literals;

std::string unpack(std::string_view packed) {
    ByteBuffer text;
    text.append("<");
    const std::string_view problem = unpackMeatPack(packed, text);
    return problem.empty() ? std::string(text.view().substr(1)) : std::string("!").append(problem);
}

TEST(MeatPack, HandMade) {
    EXPECT_EQ(unpack("G1 X1\n"), "G1 X1\n");  // packing starts off
    // on; "G1" " X" "1." "5\n"
    EXPECT_EQ(unpack("\xff\xff\xfb\x1d\xeb\xa1\xc5"s), "G1 X1.5\n");
    // "Y" has no code: low nibble 15 and the byte; high nibble 15 and the byte; both
    EXPECT_EQ(unpack("\xff\xff\xfb\x1fY\xf1Y\xffYF"s), "Y11YYF");
    // no spaces: code 11 is E, until spaces return
    EXPECT_EQ(unpack("\xff\xff\xfb\xff\xff\xf7\x1b\xff\xff\xf6\x1b"s), "E1 1");
    // a line of odd length fills its last byte with anything
    EXPECT_EQ(unpack("\xff\xff\xfb\x1d\x0c\xfc\x1d"s), "G1\n\nG1");
    // off for a comment, and on again
    EXPECT_EQ(unpack("\xff\xff\xfb\x1d\xff\xff\xfa;hi\xff\xff\xfb\x1d"s), "G1;hiG1");
    EXPECT_EQ(unpack("a\xffz"s), "a\xffz");  // one signal byte is a character
}

TEST(MeatPack, CutOrUnknown) {
    EXPECT_EQ(unpack("\xff\xff"s).front(), '!');
    EXPECT_EQ(unpack("\xff\xff\x01"s).front(), '!');
    EXPECT_EQ(unpack("\xff\xff\xff\xff"s).front(), '!');
    EXPECT_EQ(unpack("\xff\xff\xfb\x1f"s).front(), '!');
    EXPECT_EQ(unpack("\xff\xff\xfb\xf1"s).front(), '!');
    EXPECT_EQ(unpack("\xff\xff\xfb\xffY"s).front(), '!');
    EXPECT_EQ(unpack("\xff\xff\xfb\xff"s).front(), '!');
}

TEST(MeatPack, RoundTripWithComments) {
    const std::string text = sample::program(20);
    EXPECT_EQ(unpack(sample::meatpack(text, true)), text);
}

TEST(MeatPack, RoundTripWithoutCommentsAndSpaces) {
    std::string text = "G1X10.5Y20E.25\nM83\nG1X1Y22.25E1.5F600\nG92E0\n";
    EXPECT_EQ(unpack(sample::meatpack("; gone\n" + text, false)), text);
}

}  // namespace
}  // namespace stratum::gcode
