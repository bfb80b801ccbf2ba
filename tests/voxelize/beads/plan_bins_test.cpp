#include "voxelize/beads/plan_bins.h"

#include "base/error.h"
#include "toolpaths.h"
#include "voxelize/beads/footprint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <utility>
#include <vector>

namespace stratum::voxelize {
namespace {

using test::addArc;
using test::addBead;
using test::allBeads;

TEST(PlanBins, EveryBeadIsInEveryColumnItsBandReaches) {
    gcode::Toolpath toolpath;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> where(-6, 6);
    for (int n = 0; n < 40; ++n) {
        if (n % 3 == 0)
            addArc(toolpath, where(random), where(random), 2.5, where(random), where(random), 0.2, 0.2, 0.5, 0.2);
        else
            addBead(toolpath, where(random), where(random), 0.2, where(random), where(random), n % 5 == 0 ? 0.3 : 0.2,
                    0.5, 0.2);
    }
    Lattice lattice;
    lattice.voxel_size = 0.1;
    const LayerStack stack = stackLayers(toolpath, allBeads(toolpath));
    const PlanBins bins(toolpath, stack, lattice, std::size_t{1} << 30);
    std::size_t samples = 0;
    for (std::size_t c = 0; c < bins.size(); ++c) {
        std::set<std::uint32_t> present;
        EXPECT_TRUE(std::is_sorted(bins[c].begin(), bins[c].end()));  // layer by layer, direct beads last
        for (const std::uint32_t rank : bins[c]) present.insert(stack.beads[rank]);
        EXPECT_EQ(present.size(), bins[c].size());
        for (std::uint32_t bead = 0; bead < toolpath.beads.size(); ++bead) {
            const BeadField field(toolpath, toolpath.beads[bead]);
            const double reach = field.halfFlat() + field.radius() + lattice.background();
            for (int x = 0; x < kLeafDim; ++x)
                for (int y = 0; y < kLeafDim; ++y) {
                    const double rho = field.path().distance((bins.originI(c) + x) * 0.1, (bins.originJ(c) + y) * 0.1);
                    if (rho < reach) {
                        ++samples;
                        EXPECT_TRUE(present.contains(bead));
                    }
                }
        }
    }
    EXPECT_GT(samples, 1000U);
}

// Two square towers, the second this far from the first along both axes.
gcode::Toolpath towers(double apart) {
    gcode::Toolpath toolpath;
    constexpr double kEdge = 3;
    for (int layer = 1; layer <= 5; ++layer)
        for (const double at : {0.0, apart}) {
            const double z = 0.2 * layer;
            const double end = at + kEdge;
            addBead(toolpath, at, at, z, end, at, z, 0.5, 0.2);
            addBead(toolpath, end, at, z, end, end, z, 0.5, 0.2);
            addBead(toolpath, end, end, z, at, end, z, 0.5, 0.2);
            addBead(toolpath, at, end, z, at, at, z, 0.5, 0.2);
        }
    return toolpath;
}

TEST(PlanBins, ColumnsAreFoundByTheirPlace) {
    const gcode::Toolpath toolpath = towers(-31);
    const LayerStack stack = stackLayers(toolpath, allBeads(toolpath));
    Lattice lattice;
    lattice.voxel_size = 0.05;
    const PlanBins bins(toolpath, stack, lattice, std::size_t{1} << 30);
    std::set<std::pair<int, int>> listed;
    for (std::size_t c = 0; c < bins.size(); ++c) {
        EXPECT_FALSE(bins[c].empty());
        EXPECT_EQ(bins.find(bins.columnI(c), bins.columnJ(c)), c);
        const PlanBins::Block& block = bins.blocks()[bins.blockOf(c)];
        EXPECT_TRUE(block.first <= c && c < block.last);
        listed.emplace(bins.columnI(c), bins.columnJ(c));
    }
    EXPECT_EQ(listed.size(), bins.size());
    const ColumnRange& all = bins.rectangle();
    for (int j = all.j0 - 2; j <= all.j1 + 2; ++j)
        for (int i = all.i0 - 2; i <= all.i1 + 2; ++i)
            EXPECT_EQ(bins.find(i, j) != PlanBins::kNone, listed.contains({i, j}));
}

// A table over the rectangle would have 1e11 columns.
TEST(PlanBins, FarPartsTakeWhatTheirBeadsNeed) {
    Lattice lattice;
    lattice.voxel_size = 0.025;
    const auto listsOf = [&](double apart) {
        const gcode::Toolpath toolpath = towers(apart);
        const LayerStack stack = stackLayers(toolpath, allBeads(toolpath));
        const PlanBins bins(toolpath, stack, lattice, std::size_t{1} << 30);
        return std::pair(bins.entryCount(), bins.bytes());
    };
    const auto [near_entries, near_bytes] = listsOf(20);
    const auto [far_entries, far_bytes] = listsOf(80'000);
    EXPECT_EQ(near_entries, far_entries);
    EXPECT_LT(far_bytes, near_bytes + near_bytes / 4);
}

// The columns of the only bead are those of its rectangle within reach, each tested by itself.
void expectEveryColumn(const gcode::Toolpath& toolpath) {
    const gcode::Bead& bead = toolpath.beads[0];
    const Footprints footprints(toolpath, 0.4, 0.175, 0.15, Footprints::Reach::solid);
    const double reach = footprints.limit(bead);
    const ColumnRange all = footprints.range(bead, reach);
    const gcode::PlanPath path(toolpath, bead);
    std::vector<std::pair<int, int>> expected;
    for (int j = all.j0; j <= all.j1; ++j)
        for (int i = all.i0; i <= all.i1; ++i)
            if (path.distance(i * 0.4 + 0.175, j * 0.4 + 0.175) <= reach) expected.emplace_back(i, j);
    std::vector<std::pair<int, int>> found;
    footprints.forEachColumn(bead, [&](int i0, int i1, int j) {
        for (int i = i0; i <= i1; ++i) found.emplace_back(i, j);
    });
    EXPECT_EQ(found, expected);
}

// Rows of a ring are what the whole rectangle, tested column by column, gives.
TEST(Footprints, OfArcsAreThoseOfEveryColumn) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> where(-6, 6);
    std::uniform_real_distribution<double> size(-3, 1.5);
    for (int n = 0; n < 300; ++n) {
        SCOPED_TRACE(n);
        gcode::Toolpath toolpath;
        addArc(toolpath, where(random), where(random), std::pow(10, size(random)), where(random), where(random), 0.2,
               0.2, 0.5, 0.2);
        // The two ends may lie on circles of slightly different size.
        if (n % 3 == 0) toolpath.beads[0].x1 = toolpath.beads[0].x1 + 0.02;
        expectEveryColumn(toolpath);
    }
}

// Rows of a capsule likewise: in all directions, level, upright, and without a length.
TEST(Footprints, OfLinesAreThoseOfEveryColumn) {
    std::mt19937 random(6);
    std::uniform_real_distribution<double> where(-6, 6);
    std::uniform_real_distribution<double> length(-4, 1);
    for (int n = 0; n < 1000; ++n) {
        const double x = where(random);
        const double y = where(random);
        const double dx = n % 4 == 1 || n % 4 == 3 ? 0 : where(random) * std::pow(10, length(random));
        const double dy = n % 4 == 2 || n % 4 == 3 ? 0 : where(random) * std::pow(10, length(random));
        SCOPED_TRACE(n);
        gcode::Toolpath toolpath;
        addBead(toolpath, x, y, 0.2, x + dx, y + dy, 0.2, 0.5, 0.2);
        expectEveryColumn(toolpath);
    }
}

TEST(PlanBins, RefusesBeforeItAllocates) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 0.2, 1000, 1000, 0.2, 0.5, 0.2);
    Lattice lattice;
    lattice.voxel_size = 1e-5;
    const LayerStack stack = stackLayers(toolpath, allBeads(toolpath));
    EXPECT_THROW(PlanBins(toolpath, stack, lattice, std::size_t{1} << 30), UsageError);
}

// The message tells what is free, what is needed, and voxels that fit.
TEST(PlanBins, TheRefusalIsTrue) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 0.2, 100, 100, 0.2, 0.5, 0.2);
    const LayerStack stack = stackLayers(toolpath, allBeads(toolpath));
    Lattice lattice;
    constexpr std::size_t kFree = 40'000'000;
    lattice.voxel_size = 0.001;
    std::string said;
    try {
        PlanBins(toolpath, stack, lattice, kFree);
    } catch (const UsageError& error) {
        said = error.what();
    }
    EXPECT_NE(said.find("more than a quarter of the 40.0 MB that are free"), std::string::npos) << said;
    const std::size_t at = said.find("about ", said.find("choose voxels"));
    ASSERT_NE(at, std::string::npos) << said;
    lattice.voxel_size *= std::stod(said.substr(at + 6));
    EXPECT_NO_THROW(PlanBins(toolpath, stack, lattice, kFree)) << said;
}

}  // namespace
}  // namespace stratum::voxelize
