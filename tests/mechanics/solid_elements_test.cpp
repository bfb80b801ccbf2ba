#include "mechanics/solid_elements.h"

#include "toolpaths.h"

#include "base/error.h"
#include "mechanics/pieces.h"
#include "voxelize/grid/solid_check.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>
#include <tuple>

namespace stratum::mechanics {
namespace {

using gcode::Toolpath;

// Three layers of lines, the second across, and an arc.
Toolpath crossed() {
    Toolpath toolpath;
    for (int n = 0; n < 5; ++n) test::addBead(toolpath, 0, 0.4 * n, 0.2, 4, 0.4 * n, 0.2, 0.45, 0.2);
    for (int n = 0; n < 5; ++n) test::addBead(toolpath, 0.8 * n, 0, 0.4, 0.8 * n, 2, 0.4, 0.45, 0.2);
    for (int n = 0; n < 5; ++n) test::addBead(toolpath, 0, 0.4 * n, 0.6, 4, 0.4 * n, 0.6, 0.45, 0.2);
    return toolpath;
}

voxelize::Lattice latticeOf(const Toolpath& toolpath, int per_layer) {
    const auto all = test::allBeads(toolpath);
    voxelize::LatticeRequest request;
    request.voxels_per_layer = per_layer;
    voxelize::Bounds bounds;
    bounds.min[0] = bounds.min[1] = -1;
    bounds.min[2] = 0;
    bounds.max[0] = bounds.max[1] = 10;
    bounds.max[2] = 1;
    return voxelize::chooseLattice(toolpath, all, bounds, request);
}

SolidElements elementsOf(const Toolpath& toolpath, int per_layer) {
    return solidElements(toolpath, test::allBeads(toolpath), latticeOf(toolpath, per_layer));
}

class SolidElementsOf : public testing::TestWithParam<int> {};

// Twelve layers: two walls around lines that cross from layer to layer, a fifth of the area.
Toolpath box() {
    Toolpath toolpath;
    for (int layer = 1; layer <= 12; ++layer) {
        const double z = 0.2 * layer;
        for (const double in : {0.0, 0.4}) {
            test::addBead(toolpath, in, in, z, 12 - in, in, z, 0.45, 0.2);
            test::addBead(toolpath, 12 - in, in, z, 12 - in, 9 - in, z, 0.45, 0.2);
            test::addBead(toolpath, 12 - in, 9 - in, z, in, 9 - in, z, 0.45, 0.2);
            test::addBead(toolpath, in, 9 - in, z, in, in, z, 0.45, 0.2);
        }
        for (double at = 1.7; at < 8; at += 2.1) {
            if (layer % 2 == 0)
                test::addBead(toolpath, at, 0.6, z, at + 3, 8.4, z, 0.45, 0.2);
            else
                test::addBead(toolpath, 0.6, at, z, 11.4, at, z, 0.45, 0.2);
        }
    }
    return toolpath;
}

class KeptPlastic : public testing::TestWithParam<double> {};

TEST_P(KeptPlastic, IsAllOfItInOnePiece) {
    const Toolpath toolpath = box();
    const auto all = test::allBeads(toolpath);
    voxelize::Bounds bounds;
    bounds.include({{-1, -1, 0}, {13, 10, 2.4}});
    voxelize::LatticeRequest request;
    request.voxel_size = 0.2 * GetParam();
    SolidElements elements = solidElements(toolpath, all, voxelize::chooseLattice(toolpath, all, bounds, request));
    request.voxel_size = 0.05;
    const auto grid = voxelize::voxelize(toolpath, all, voxelize::chooseLattice(toolpath, all, bounds, request));
    const double plastic = voxelize::enclosedVolume(*grid);
    EXPECT_NEAR(elements.plastic / plastic, 1, 0.01);
    EXPECT_NEAR(elements.volume() / plastic, 1, 0.01);
    EXPECT_EQ(keepLargestPiece(elements).count, 1U);
}

// In layers; the others divide none.
INSTANTIATE_TEST_SUITE_P(Layers, KeptPlastic, testing::Values(0.25, 0.5, 0.7, 1.0, 1.3, 1.75, 2.0, 2.5, 4.0));

// The bead of an element is the one nearest to what is plastic in it.
TEST_P(SolidElementsOf, AreOfTheNearestBead) {
    const Toolpath toolpath = crossed();
    const SolidElements elements = elementsOf(toolpath, GetParam());
    const auto middle = [&](int n, int axis) { return elements.origin[axis] + (n + 0.5) * elements.edge; };
    std::size_t nearest_ones = 0;
    for (const SolidElement& e : elements.list) {
        const double x = middle(e.i, 0);
        const double y = middle(e.j, 1);
        const double z = middle(e.k, 2);
        double nearest = 1e9;
        for (const gcode::Bead& bead : toolpath.beads)
            nearest = std::min(nearest, test::levelBeadDistance(toolpath, bead, x, y, z));
        const double found = test::levelBeadDistance(toolpath, toolpath.beads[e.bead], x, y, z);
        EXPECT_LT(found, 0.87 * elements.edge);
        nearest_ones += found < nearest + 1e-5 ? 1U : 0U;
    }
    EXPECT_GT(static_cast<double>(nearest_ones), 0.9 * static_cast<double>(elements.list.size()));
}

TEST_P(SolidElementsOf, BeginAndEndOnLayerPlanes) {
    const Toolpath toolpath = crossed();
    const SolidElements elements = elementsOf(toolpath, GetParam());
    EXPECT_NEAR(elements.origin[2] + elements.list.front().k * elements.edge, 0.0, 1e-9);
    EXPECT_NEAR(elements.origin[2] + (elements.list.back().k + 1) * elements.edge, 0.6, 1e-9);
}

TEST_P(SolidElementsOf, AreOrdered) {
    const SolidElements elements = elementsOf(crossed(), GetParam());
    for (std::size_t n = 1; n < elements.list.size(); ++n) {
        const SolidElement& a = elements.list[n - 1];
        const SolidElement& b = elements.list[n];
        ASSERT_LT(std::tie(a.k, a.j, a.i), std::tie(b.k, b.j, b.i));
    }
}

INSTANTIATE_TEST_SUITE_P(PerLayer, SolidElementsOf, testing::Values(1, 2, 4, 8, 16));

TEST(SolidElements, HoldTheVolumeOfASlopedTube) {
    Toolpath toolpath;
    test::addBead(toolpath, 0, 0, 0.2, 10, 0, 0.2, 1.0, 0.2);
    test::addBead(toolpath, 0, 3, 1.2, 10, 3, 4.2, 0.8, 0.8);
    voxelize::Lattice lattice = latticeOf(toolpath, 4);
    lattice.voxel_size = 0.05;
    lattice.layer_height = 0.2;
    lattice.origin_z = 0;
    const SolidElements elements = solidElements(toolpath, test::allBeads(toolpath), lattice);
    const double length = std::hypot(10, 3);
    const double pi = std::numbers::pi;
    const double rod = pi * 0.16 * length + 4.0 / 3 * pi * 0.064;
    const double level = 10 * (0.8 * 0.2 + pi * 0.01) + 0.2 * pi * 0.16 + pi * pi * 0.4 * 0.01 + 4.0 / 3 * pi * 0.001;
    // It is as thick as that, and a little thicker below: kSlopedReach.
    EXPECT_NEAR(elements.volume() / (rod + level), 1, 0.02);
    lattice.voxel_size = 0.02;
    const auto grid = voxelize::voxelize(toolpath, test::allBeads(toolpath), lattice);
    EXPECT_NEAR(elements.volume() / voxelize::enclosedVolume(*grid), 1, 0.005);
}

TEST(SolidElements, DoNotDependOnTheNumberOfThreads) {
    const Toolpath toolpath = crossed();
    const auto with = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return elementsOf(toolpath, 4);
    };
    const SolidElements one = with(1);
    const SolidElements many = with(4);
    ASSERT_EQ(one.list.size(), many.list.size());
    for (std::size_t n = 0; n < one.list.size(); ++n) {
        const SolidElement& a = one.list[n];
        const SolidElement& b = many.list[n];
        ASSERT_EQ(std::tie(a.i, a.j, a.k, a.bead), std::tie(b.i, b.j, b.k, b.bead));
    }
}

TEST(SolidElements, TooManyAreRefusedWithASizeThatFits) {
    const Toolpath toolpath = crossed();
    const auto all = test::allBeads(toolpath);
    const std::size_t count = elementsOf(toolpath, 8).list.size();
    for (const std::size_t most : {count - 1, count / 100}) {
        double advised = 0;
        try {
            solidElements(toolpath, all, latticeOf(toolpath, 8), {most, {}});
            FAIL();
        } catch (const UsageError& error) {
            const std::string text = error.what();
            advised = std::stod(text.substr(text.find("--voxel-size ") + 13));
        }
        voxelize::Lattice coarser = latticeOf(toolpath, 8);
        coarser.voxel_size = advised;
        coarser.origin_z = advised > 0.19 ? 0.5 * advised : 0;
        EXPECT_LE(solidElements(toolpath, all, coarser).list.size(), most);
    }
    EXPECT_EQ(solidElements(toolpath, all, latticeOf(toolpath, 8), {count, {}}).list.size(), count);
    EXPECT_THROW(elementsOf(toolpath, 17), UsageError);
}

}  // namespace
}  // namespace stratum::mechanics
