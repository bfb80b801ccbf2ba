#include "gcode/container/container.h"

#include "base/error.h"
#include "refusal.h"

#include <gtest/gtest.h>

#include <string>

namespace stratum::gcode {
namespace {

using namespace std::string_literals;

struct SniffCase {
    std::string bytes;
    std::string_view message;
};

TEST(Sniff, SaysWhatItIs) {
    std::string stl(80, ' ');
    stl += "\x02\0\0\0"s + std::string(100, 'x');
    const SniffCase cases[] = {
        {"", "empty"},
        {"\x1f\x8b\x08\0\0"s, "gzip"},
        {"PK\x03\x04rest"s, "zip"},
        {"GCDE\x01\0\0\0"s, "bgcode"},
        {stl, "STL"},
        {"solid cube\n facet normal 0 0 1\n", "STL"},
        {"\xff\xfeG\0\x31\0"s, "UTF-16"},
        {"G1 X1\n\0\0\0"s, "offset 6"},
    };
    for (const SniffCase& c : cases) {
        try {
            refuseOtherFormats(c.bytes, "a.gcode");
            ADD_FAILURE() << c.message;
        } catch (const InputError& error) {
            const std::string text = error.what();
            EXPECT_TRUE(text.starts_with("a.gcode: ")) << text;
            EXPECT_NE(text.find(c.message), std::string::npos) << text;
        }
    }
}

TEST(Sniff, LetsTextPass) {
    for (const auto* text : {"G1 X1\n", "; solid infill\nG1", "solid\n", "\xef\xbb\xbfG1", "P", "G"})
        EXPECT_NO_THROW(refuseOtherFormats(text, "a")) << text;
}

TEST(Sniff, OtherPeoplesFiles) {
    const SniffCase cases[] = {
        {std::string(5, '\0'), "only zero bytes"},
        {"version https://git-lfs.github.com/spec/v1\noid", "git lfs pull"},
        {"<!DOCTYPE html>", "web page"},
        {"\x89PNG\r\n", "PNG"},
        {"ISO-10303-21;", "STEP"},
        {"IN;SP1;PU0,0;", "plotter"},
        {"3DPFNKG13WTW", "XYZprinting"},
        {"\x95\0\x20\x01SFX\0\x88\0"s, ".x3g"},
        {"{\"a\": 1}", "JSON"},
        {"NanoVDB0\2\x10\0\4"s, "NanoVDB"},
        {"\x76\x2f\x31\x01\2\0\0\0"s, "OpenEXR"},
        {"#?RADIANCE\n", "map of light"},
    };
    for (const SniffCase& c : cases) {
        EXPECT_TRUE(test::refuses<InputError>(c.message, [&] { refuseOtherFormats(c.bytes, "a.gcode"); })) << c.message;
    }
}

TEST(Sniff, ZeroBytesAtTheEndAreNoMatter) {
    EXPECT_EQ(withoutZeroTail("G1 X1\n\0\0\x1a\0"s), "G1 X1\n");
    EXPECT_EQ(withoutZeroTail("G1"), "G1");
    EXPECT_EQ(withoutZeroTail("\0\0"s), "");
}

}  // namespace
}  // namespace stratum::gcode
