#include "voxelize/leaf/leaf_mask.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace stratum::voxelize {
namespace {

// 24^3 bits as plain booleans: what the masks stand for.
class Block {
public:
    bool& at(int x, int y, int z) { return bits_[index(x, y, z)]; }
    static bool inside(int x, int y, int z) { return x >= -8 && y >= -8 && z >= -8 && x < 16 && y < 16 && z < 16; }
    bool get(int x, int y, int z) const { return inside(x, y, z) && bits_[index(x, y, z)]; }

    std::array<LeafMask, 27> masks() const {
        std::array<LeafMask, 27> out;
        for (int x = -8; x < 16; ++x)
            for (int y = -8; y < 16; ++y)
                for (int z = -8; z < 16; ++z)
                    if (get(x, y, z)) {
                        LeafMask& mask = out[neighbourIndex((x + 8) / 8 - 1, (y + 8) / 8 - 1, (z + 8) / 8 - 1)];
                        mask.word[static_cast<std::size_t>(x & 7)] |= std::uint64_t{1} << ((y & 7) * 8 + (z & 7));
                    }
        return out;
    }

private:
    static std::size_t index(int x, int y, int z) {
        return static_cast<std::size_t>(((x + 8) * 24 + y + 8) * 24 + z + 8);
    }
    std::array<bool, 24 * 24 * 24> bits_{};
};

Block randomBlock(double share, std::uint32_t seed) {
    Block block;
    std::mt19937 random(seed);
    std::bernoulli_distribution set(share);
    for (int x = -8; x < 16; ++x)
        for (int y = -8; y < 16; ++y)
            for (int z = -8; z < 16; ++z) block.at(x, y, z) = set(random);
    return block;
}

Neighbourhood pointersTo(const std::array<LeafMask, 27>& masks) {
    Neighbourhood around{};
    for (std::size_t n = 0; n < masks.size(); ++n) around[n] = masks[n].empty() ? nullptr : &masks[n];
    return around;
}

bool bit(const LeafMask& mask, int x, int y, int z) {
    return (mask.word[static_cast<std::size_t>(x)] >> (y * 8 + z) & 1) != 0;
}

template <typename Expected>
void expectMiddle(const LeafMask& mask, const Expected& expected) {
    for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 8; ++y)
            for (int z = 0; z < 8; ++z) ASSERT_EQ(bit(mask, x, y, z), expected(x, y, z)) << x << " " << y << " " << z;
}

TEST(LeafMask, WithinReachIsABall) {
    for (const double reach : {1.0, 2.0, 2.5, 3.0, 8.0}) {
        const Block block = randomBlock(reach > 4 ? 0.0005 : 0.005, 5);
        const auto masks = block.masks();
        const int r = static_cast<int>(reach);
        expectMiddle(dilateBall(pointersTo(masks), reach), [&](int x, int y, int z) {
            for (int dx = -r; dx <= r; ++dx)
                for (int dy = -r; dy <= r; ++dy)
                    for (int dz = -r; dz <= r; ++dz)
                        if (dx * dx + dy * dy + dz * dz <= reach * reach && block.get(x + dx, y + dy, z + dz))
                            return true;
            return false;
        });
    }
}

TEST(LeafMask, AnyWithinLooksAsFarAsAsked) {
    for (int reach = 1; reach <= 8; ++reach)
        for (std::uint32_t seed = 0; seed < 60; ++seed) {
            const Block block = randomBlock(0.0002, seed);
            const auto masks = block.masks();
            bool expected = false;
            for (int x = -reach; x < 8 + reach; ++x)
                for (int y = -reach; y < 8 + reach; ++y)
                    for (int z = -reach; z < 8 + reach; ++z) expected = expected || block.get(x, y, z);
            ASSERT_EQ(anyWithin(pointersTo(masks), reach), expected) << reach << " " << seed;
        }
}

TEST(LeafMask, SpreadThroughTakesThatManySteps) {
    for (const int steps : {1, 3, 4, 8}) {
        const Block open = randomBlock(0.2, 9);
        Block reached = randomBlock(0.002, 10);
        const auto open_masks = open.masks();
        const auto seed_masks = reached.masks();
        for (int step = 0; step < steps; ++step) {
            const Block before = reached;
            for (int x = -8; x < 16; ++x)
                for (int y = -8; y < 16; ++y)
                    for (int z = -8; z < 16; ++z)
                        for (int n = 0; n < 27 && open.get(x, y, z); ++n)
                            if (before.get(x + n / 9 - 1, y + n / 3 % 3 - 1, z + n % 3 - 1)) reached.at(x, y, z) = true;
        }
        expectMiddle(spreadThrough(pointersTo(open_masks), pointersTo(seed_masks), steps),
                     [&](int x, int y, int z) { return reached.get(x, y, z); });
    }
}

TEST(LeafMask, FloodStaysWithinAndGoesFromFaceToFace) {
    // A snake through the leaf: every other row open, joined at alternating ends; and a diagonal neighbour that is not.
    LeafMask open;
    for (int y = 0; y < 8; y += 2) {
        for (int z = 0; z < 8; ++z) open.word[0] |= std::uint64_t{1} << (y * 8 + z);
        if (y < 6) open.word[0] |= std::uint64_t{1} << ((y + 1) * 8 + (y % 4 == 0 ? 7 : 0));
    }
    LeafMask wanted = open;
    open.word[1] |= std::uint64_t{1} << 9;  // (1, 1, 1): only edges in common
    open.word[0] &= ~(std::uint64_t{1} << 1);
    open.word[0] |= std::uint64_t{1} << 1;
    LeafMask seed;
    seed.word[0] = 1;
    EXPECT_EQ(floodWithin(open, seed), wanted);
    LeafMask closed;
    closed.word[5] = 1;
    EXPECT_TRUE(floodWithin(open, closed).empty());
}

}  // namespace
}  // namespace stratum::voxelize
