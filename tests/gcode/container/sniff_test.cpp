#include "gcode/container/sniff.h"

#include "base/error.h"

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

}  // namespace
}  // namespace stratum::gcode
