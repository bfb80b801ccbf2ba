#include "base/shard.h"

#include "base/error.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

TEST(Shard, ReadsItsShare) {
    EXPECT_EQ(parseShard("0/1"), (Shard{0, 1}));
    EXPECT_EQ(parseShard("7/64"), (Shard{7, 64}));
    for (const char* bad : {"", "1", "1/", "/1", "1/1", "-1/2", "0/0", "0/-1", "0x/2", "0/2 ", "0/1/2", "0/9999999"})
        EXPECT_THROW(parseShard(bad), UsageError) << bad;
}

TEST(Shard, IsATaskOfAnArray) {
    EXPECT_EQ(shardOf({"5", "4", "7", "4"}), (Shard{1, 4}));
    EXPECT_EQ(shardOf({"0", "0", "", "3"}), (Shard{0, 3}));
    EXPECT_THROW(shardOf({"", "", "", ""}), UsageError);
    EXPECT_THROW(shardOf({"6", "0", "6", "4"}), UsageError);  // --array=0-6:2
    EXPECT_THROW(shardOf({"2", "0", "6", "4"}), UsageError);
    EXPECT_THROW(shardOf({"1", "2", "3", "2"}), UsageError);
    EXPECT_THROW(shardOf({"0", "0", "0", "0"}), UsageError);
}

TEST(Shard, NamesItsFile) {
    EXPECT_EQ(shardName("a/part.png", {2, 7}, ".exr"), "a/part.2of7.exr");
    EXPECT_EQ(shardName("part.state", {0, 1}), "part.0of1.state");
    EXPECT_EQ(shardName("state", {0, 1}), "state.0of1");
}

}  // namespace
}  // namespace stratum
