#include "voxelize/grid/leaf_share.h"

#include "toolpaths.h"
#include "voxelize/grid/leaf_blocks.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

namespace stratum::voxelize {
namespace {

constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();

// Lines, arcs and slopes at random places, on both sides of the origin; `high`: some in other upper nodes.
gcode::Toolpath mixedPrint(unsigned seed, double size, bool high) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-size / 2, size / 2);
    gcode::Toolpath toolpath;
    for (int n = 0; n < 120; ++n) {
        const double z = 0.2 * (1 + n / 20) + (high && n % 3 == 0 ? 405 : 0);
        if (n % 7 == 0)
            test::addArc(toolpath, place(random), place(random), 0.2 * size, place(random), 3.0, z, z, 0.45, 0.2);
        else
            test::addBead(toolpath, place(random), place(random), z, place(random), place(random),
                          n % 11 == 0 ? z + 0.1 : z, 0.45, 0.2);
    }
    return toolpath;
}

Lattice fineLattice() {
    Lattice lattice;
    lattice.voxel_size = 0.1;
    lattice.layer_height = 0.2;
    return lattice;
}

TEST(LeafShare, SharesAreAllBlocksInTheirOrder) {
    const gcode::Toolpath toolpath = mixedPrint(1, 80, true);
    const LayerStack stack = stackLayers(toolpath, test::allBeads(toolpath));
    const Lattice lattice = fineLattice();
    const PlanBins bins(toolpath, stack, lattice, kNoLimit);
    std::size_t all = 0;
    forEachBlock(rectangleOf(bins), leavesAround(lattice, stack), [&](std::size_t, const LeafBlock&) { ++all; });
    EXPECT_GT(all, 60U);
    for (const int count : {1, 2, 7, 64, 1000}) {
        std::size_t next = 0;
        for (int n = 0; n < count; ++n) {
            const LeafShare share = shareOf(toolpath, stack, lattice, {n, count});
            EXPECT_EQ(share.blocks.first, next) << n << " of " << count;
            next = share.blocks.end;
        }
        EXPECT_EQ(next, all) << count;
    }
}

// And no others than those of all beads.
TEST(LeafShare, BinsHaveEveryBeadThatReachesABlock) {
    const gcode::Toolpath toolpath = mixedPrint(2, 60, true);
    const LayerStack stack = stackLayers(toolpath, test::allBeads(toolpath));
    const Lattice lattice = fineLattice();
    const PlanBins all(toolpath, stack, lattice, kNoLimit);
    const LeafRange heights = leavesAround(lattice, stack);
    std::size_t found = 0;
    for (int n = 0; n < 5; ++n) {
        const LeafShare share = shareOf(toolpath, stack, lattice, {n, 5});
        const PlanBins own(toolpath, stack, lattice, kNoLimit, &share.tiles);
        ASSERT_EQ(own.size(), all.size());
        EXPECT_LT(own.entryCount(), all.entryCount());
        for (std::size_t c = 0; c < all.size(); ++c) {
            ASSERT_EQ(own.originI(c), all.originI(c));
            ASSERT_EQ(own.originJ(c), all.originJ(c));
            EXPECT_TRUE(std::includes(all[c].begin(), all[c].end(), own[c].begin(), own[c].end()));
        }
        forEachBlock(rectangleOf(all), heights, [&](std::size_t number, const LeafBlock& block) {
            if (!share.blocks.has(number)) return;
            forEachColumnOf(block, all, [&](std::size_t bin, std::size_t) {
                for (const std::uint32_t rank : all[bin]) {
                    const Bounds solid = BeadField(toolpath, toolpath.beads[stack.beads[rank]]).bounds();
                    if (leavesIn(block.heights, leavesAround(lattice, solid.min[2], solid.max[2])) == 0) continue;
                    ++found;
                    ASSERT_TRUE(std::binary_search(own[bin].begin(), own[bin].end(), rank));
                }
            });
        });
    }
    EXPECT_GE(found, all.entryCount());
}

TEST(LeafShare, BoundsOfLeavesAddUp) {
    for (const bool high : {false, true}) {
        const gcode::Toolpath toolpath = mixedPrint(3, 50, high);
        const std::vector<std::uint32_t> beads = test::allBeads(toolpath);
        const Lattice lattice = fineLattice();
        VoxelizeOptions options;
        options.in_memory = false;
        const LeafBounds whole = Voxelizer(toolpath, beads, lattice, options).leafBounds();
        std::size_t leaves = 0;
        std::size_t lower_nodes = 0;
        for (int n = 0; n < 7; ++n) {
            options.shard = Shard{n, 7};
            const LeafBounds own = Voxelizer(toolpath, beads, lattice, options).leafBounds();
            leaves += own.leaves;
            lower_nodes += own.lower_nodes;
            EXPECT_EQ(own.print.lower_nodes, own.lower_nodes);
            EXPECT_EQ(own.print.upper_nodes, whole.print.upper_nodes);
            EXPECT_EQ(own.heights, whole.heights);
        }
        EXPECT_EQ(leaves, whole.leaves);
        EXPECT_EQ(lower_nodes, whole.lower_nodes);
    }
}

// Even where all of a print is long lines, which lie in many blocks, or circles, whose chord is a point.
TEST(LeafShare, AreAboutAlike) {
    gcode::Toolpath lines;
    gcode::Toolpath circles;
    for (int n = 0; n < 400; ++n) {
        test::addBead(lines, -60, 0.3 * n - 60, 0.2, 60, 0.3 * n - 60, 0.2, 0.45, 0.2);
        test::addArc(circles, 0, 0, 0.15 * n + 0.1, 0, 6.283, 0.2, 0.2, 0.45, 0.2);
    }
    const Lattice lattice = fineLattice();
    for (const gcode::Toolpath* toolpath : {&lines, &circles}) {
        const LayerStack stack = stackLayers(*toolpath, test::allBeads(*toolpath));
        std::vector<double> entries;
        for (int n = 0; n < 4; ++n) {
            const LeafShare share = shareOf(*toolpath, stack, lattice, {n, 4});
            const PlanBins bins(*toolpath, stack, lattice, kNoLimit, &share.tiles);
            entries.push_back(static_cast<double>(bins.entryCount()));
        }
        const double mean = std::accumulate(entries.begin(), entries.end(), 0.0) / 4;
        EXPECT_LT(*std::max_element(entries.begin(), entries.end()), 1.2 * mean);
        EXPECT_GT(*std::min_element(entries.begin(), entries.end()), 0.8 * mean);
    }
}

}  // namespace
}  // namespace stratum::voxelize
