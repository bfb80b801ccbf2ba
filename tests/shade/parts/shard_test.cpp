#include "shade/parts/shard.h"

#include "base/error.h"
#include "shade/integrator/render.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace stratum {
namespace {

using shade::parseShard;
using shade::PixelBox;
using shade::Shard;
using shade::shardName;
using shade::shardOf;

int tilesIn(const PixelBox& box) { return static_cast<int>(shade::tilesOf(box).size()); }

// Every pixel of the region is in one piece, and every piece is of whole tiles of it.
void expectCut(const PixelBox& region, int count) {
    const std::vector<PixelBox> pieces = shade::piecesOf(region, count);
    ASSERT_EQ(pieces.size(), static_cast<std::size_t>(count));
    std::vector<int> owners(static_cast<std::size_t>(region.width()) * static_cast<std::size_t>(region.height()));
    for (const PixelBox& piece : pieces) {
        ASSERT_TRUE(piece.x0 < piece.x1 && piece.y0 < piece.y1);
        const auto edge = [](int at, int low, int high) { return at % shade::kTile == 0 || at == low || at == high; };
        EXPECT_TRUE(edge(piece.x0, region.x0, region.x1) && edge(piece.x1, region.x0, region.x1));
        EXPECT_TRUE(edge(piece.y0, region.y0, region.y1) && edge(piece.y1, region.y0, region.y1));
        for (int y = piece.y0; y < piece.y1; ++y)
            for (int x = piece.x0; x < piece.x1; ++x)
                ++owners[static_cast<std::size_t>(y - region.y0) * static_cast<std::size_t>(region.width()) +
                         static_cast<std::size_t>(x - region.x0)];
    }
    EXPECT_TRUE(std::all_of(owners.begin(), owners.end(), [](int n) { return n == 1; })) << count;
}

TEST(Shard, ReadsItsShare) {
    EXPECT_EQ(parseShard("0/1"), (Shard{0, 1}));
    EXPECT_EQ(parseShard("7/64"), (Shard{7, 64}));
    for (const char* bad : {"", "1", "1/", "/1", "1/1", "-1/2", "0/0", "0/-1", "0x/2", "0/2 ", "0/1/2", "0/9999999",
                            "1e0/2", "a/b", "0/99999999999999999999"})
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

TEST(Shard, PiecesCoverARegionOnceForEveryCount) {
    for (const PixelBox region : {PixelBox{0, 0, 160, 120}, PixelBox{20, 10, 140, 110}, PixelBox{0, 0, 31, 200},
                                  PixelBox{64, 32, 65, 33}, PixelBox{33, 63, 300, 70}})
        for (int count = 1; count <= tilesIn(region); ++count) expectCut(region, count);
}

TEST(Shard, MorePiecesThanTilesAreRefused) {
    EXPECT_THROW(shade::piecesOf({0, 0, 160, 120}, 21), UsageError);
    EXPECT_THROW(shade::piecesOf({0, 0, 1, 1}, 2), UsageError);
}

TEST(Shard, PiecesAreBalanced) {
    const PixelBox region{0, 0, 1280, 960};  // 40 x 30 tiles
    for (int count = 1; count <= 128; ++count) {
        int largest = 0;
        for (const PixelBox& piece : shade::piecesOf(region, count)) largest = std::max(largest, tilesIn(piece));
        EXPECT_LE(largest * count, 1200 * 1.5 + count) << count;
    }
    for (const PixelBox& piece : shade::piecesOf(region, 15)) EXPECT_EQ(piece.width(), 1280);
}

TEST(Shard, ChunksAreInOrderAndLeaveNothingOut) {
    for (std::size_t count = 1; count < 40; ++count)
        for (int shards = 1; shards <= static_cast<int>(count); ++shards) {
            std::size_t at = 0;
            for (int n = 0; n < shards; ++n) {
                const auto [first, last] = shade::chunkOf(count, {n, shards});
                EXPECT_EQ(first, at);
                EXPECT_GT(last, first);
                EXPECT_LE(last - first, count / static_cast<std::size_t>(shards) + 1);
                at = last;
            }
            EXPECT_EQ(at, count);
        }
    EXPECT_THROW(shade::chunkOf(3, {0, 4}), UsageError);
}

}  // namespace
}  // namespace stratum
