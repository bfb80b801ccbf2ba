#include "voxelize/leaf/plan_layers.h"

#include "toolpaths.h"
#include "voxelize/leaf/print_columns.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <random>

namespace stratum::voxelize {
namespace {

// Lines and a slope here and there over 20 mm: columns 16 apart have the same place.
gcode::Toolpath scattered() {
    gcode::Toolpath toolpath;
    toolpath.deposit.beads = gcode::DepositModel::Beads::settled;
    toolpath.deposit.crown = 0.2;
    std::mt19937 random(11);
    std::uniform_real_distribution<double> where(0, 20);
    for (int layer = 1; layer <= 20; ++layer)
        for (int n = 0; n < 40; ++n) {
            const double x = where(random);
            const double y = where(random);
            const double z = 0.2 * layer;
            test::addBead(toolpath, x, y, z, x + 4, y + 0.5, n % 13 == 0 ? z - 0.3 : z, 0.45, 0.2);
        }
    return toolpath;
}

TEST(PlanLayers, SingleLeavesInAnyOrderAreThoseOfWholeColumns) {
    const gcode::Toolpath toolpath = scattered();
    const LayerStack stack = stackLayers(toolpath, test::allBeads(toolpath));
    Lattice lattice;
    lattice.voxel_size = 0.1;
    lattice.half_width = 3;
    const PrintColumns columns(toolpath, stack, lattice);
    LeafColumn kept(toolpath, stack, lattice, 1, LeafColumn::Kind::kept);
    std::mt19937 random(5);
    std::size_t surfaces = 0;
    std::size_t c = 0;
    for (int n = 0; n < 20000; ++n) {
        // Near the last one most of the time, as rays are.
        if (n % 8 == 0) c = random() % columns.size();
        const std::size_t at = (c + random() % 3) % columns.size();
        const int leaf = static_cast<int>(random() % 6);
        const std::uint32_t end = random() % 4 == 0 ? 500 : PrintColumns::kAllBeads;
        LeafColumn& whole = columns.open(at, end);
        kept.open(columns.bins().originI(at), columns.bins().originJ(at), columns.bins()[at], end);
        const LeafContent content = whole.evaluate(leaf, kMostPlanes);
        ASSERT_EQ(kept.evaluate(leaf, kMostPlanes), content);
        ASSERT_EQ(std::memcmp(&kept.planes(), &whole.planes(), sizeof(LeafPlanes)), 0) << n;
        surfaces += content == LeafContent::surface ? 1 : 0;
        if (n % 3 != 0) continue;
        std::array<std::uint32_t, Leaf::SIZE> owners;
        std::array<std::uint32_t, Leaf::SIZE> expected;
        kept.owners(owners);
        whole.owners(expected);
        ASSERT_EQ(owners, expected) << n;
    }
    EXPECT_GT(surfaces, 5000U);
}

TEST(PlanLayers, ASlotInUseIsNobodyElses) {
    PlanLayers layers(true);
    const PlanKey key{8, 16, 3, 100};
    const PlanKey other{8 + 16 * 8, 16, 3 + 16, 100};  // of the same place
    const std::uint32_t slot = layers.take(key);
    EXPECT_FALSE(layers.isFilled(slot));
    layers.setFilled(slot, key);
    const std::uint32_t more = layers.take(other);
    EXPECT_NE(more, slot);
    EXPECT_FALSE(layers.isFilled(more));
    layers.setFilled(more, other);
    layers.release(more);
    layers.release(slot);
    EXPECT_EQ(layers.take(key), slot);
    EXPECT_TRUE(layers.isFilled(slot));
    layers.release(slot);
    EXPECT_EQ(layers.take(other), slot);
    EXPECT_FALSE(layers.isFilled(slot));
    layers.release(slot);
    EXPECT_EQ(layers.take(key), slot);
    EXPECT_FALSE(layers.isFilled(slot));
}

TEST(PlanLayers, WithoutKeepNothingIsFilled) {
    PlanLayers layers(false);
    const PlanKey key{0, 0, 0, 1};
    const std::uint32_t slot = layers.take(key);
    layers.setFilled(slot, key);
    layers.release(slot);
    EXPECT_EQ(layers.take(key), slot);
    EXPECT_FALSE(layers.isFilled(slot));
}

}  // namespace
}  // namespace stratum::voxelize
