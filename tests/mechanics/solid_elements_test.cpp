#include "mechanics/solid_elements.h"

#include "plain_field.h"
#include "toolpaths.h"

#include "base/error.h"
#include "voxelize/beads/layer_stack.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <set>
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

TEST_P(SolidElementsOf, AreTheCubesWhoseMiddleIsInside) {
    const Toolpath toolpath = crossed();
    const SolidElements elements = elementsOf(toolpath, GetParam());
    const test::PlainField field(toolpath);
    std::set<std::tuple<int, int, int>> found;
    const auto middle = [&](int n, int axis) { return elements.origin[axis] + (n + 0.5) * elements.edge; };
    for (const SolidElement& e : elements.list) {
        found.insert({e.i, e.j, e.k});
        const double x = middle(e.i, 0);
        const double y = middle(e.j, 1);
        const double z = middle(e.k, 2);
        double nearest = 1e9;
        for (const gcode::Bead& bead : toolpath.beads)
            nearest = std::min(nearest, test::levelBeadDistance(toolpath, bead, x, y, z));
        EXPECT_NEAR(test::levelBeadDistance(toolpath, toolpath.beads[e.bead], x, y, z), nearest, 1e-5);
    }
    EXPECT_EQ(found.size(), elements.list.size());
    const int reach = static_cast<int>(5 / elements.edge);
    std::size_t inside = 0;
    for (int k = -3; k <= static_cast<int>(0.8 / elements.edge); ++k)
        for (int j = -reach / 5; j <= reach; ++j)
            for (int i = -reach / 5; i <= reach; ++i) {
                const double phi = field(middle(i, 0), middle(j, 1), middle(k, 2));
                if (std::abs(phi) < 1e-5) continue;
                const bool solid = found.count({i, j, k}) > 0;
                ASSERT_EQ(solid, phi < 0) << i << ' ' << j << ' ' << k;
                inside += solid ? 1 : 0;
            }
    EXPECT_GT(inside, 0.9 * static_cast<double>(found.size()));
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
    EXPECT_NEAR(elements.volume() / (rod + level), 1, 0.01);
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
