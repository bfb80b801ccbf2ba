#include "gcode/container/byte_buffer.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

namespace stratum::gcode {
namespace {

TEST(ByteBuffer, GrowsAndKeepsWhatItHas) {
    ByteBuffer buffer;
    EXPECT_EQ(buffer.view(), "");
    buffer.append("");
    std::string expected;
    for (int i = 0; i < 1000; ++i) {
        buffer.append("G1 X" + std::to_string(i));
        expected += "G1 X" + std::to_string(i);
    }
    EXPECT_EQ(buffer.view(), expected);
    buffer.truncate(4);
    EXPECT_EQ(buffer.view(), "G1 X");
    EXPECT_GE(buffer.spare(), expected.size() - 4);
}

TEST(ByteBuffer, AMoveKeepsTheBytesWhereTheyAre) {
    ByteBuffer buffer;
    buffer.append("G1");
    const std::string_view view = buffer.view();
    const ByteBuffer moved = std::move(buffer);
    EXPECT_EQ(moved.view().data(), view.data());
    EXPECT_EQ(moved.view(), "G1");
}

}  // namespace
}  // namespace stratum::gcode
