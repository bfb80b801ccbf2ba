// Two level sets with the same topology and the same bytes in every leaf and tile.
#pragma once

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <cstring>

namespace stratum::test {

inline void expectSame(const openvdb::FloatGrid& a, const openvdb::FloatGrid& b) {
    ASSERT_TRUE(a.tree().hasSameTopology(b.tree()));
    auto other = b.tree().cbeginLeaf();
    for (auto leaf = a.tree().cbeginLeaf(); leaf; ++leaf, ++other) {
        ASSERT_EQ(leaf->origin(), other->origin());
        ASSERT_EQ(std::memcmp(leaf->buffer().data(), other->buffer().data(), sizeof(float) * 512), 0);
    }
    auto tile = b.tree().cbeginValueOff();
    tile.setMaxDepth(openvdb::FloatTree::ValueOffCIter::LEAF_DEPTH - 1);
    auto mine = a.tree().cbeginValueOff();
    mine.setMaxDepth(openvdb::FloatTree::ValueOffCIter::LEAF_DEPTH - 1);
    for (; mine && tile; ++mine, ++tile) ASSERT_EQ(*mine, *tile);
    EXPECT_EQ(static_cast<bool>(mine), static_cast<bool>(tile));
}

}  // namespace stratum::test
