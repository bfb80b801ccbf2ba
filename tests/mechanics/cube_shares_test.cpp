#include "mechanics/cube_shares.h"

#include "plain_field.h"
#include "toolpaths.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <map>
#include <tuple>

namespace stratum::mechanics {
namespace {

using gcode::Toolpath;

// Walls of one line around lines that cross from layer to layer, off the lattice's axes.
Toolpath sparse() {
    Toolpath toolpath;
    for (int layer = 1; layer <= 8; ++layer) {
        const double z = 0.2 * layer;
        test::addBead(toolpath, 0.13, 0.07, z, 6.13, 0.37, z, 0.45, 0.2);
        test::addBead(toolpath, 6.13, 0.37, z, 5.83, 4.37, z, 0.45, 0.2);
        test::addBead(toolpath, 5.83, 4.37, z, 0.13, 0.07, z, 0.45, 0.2);
        for (int n = 1; n < 3; ++n)
            layer % 2 == 0 ? test::addBead(toolpath, 2.0 * n, 0.2, z, 2.0 * n, 1.1 * n, z, 0.45, 0.2)
                           : test::addBead(toolpath, 1.5 * n, 1.0 * n, z, 6, 1.0 * n, z, 0.45, 0.2);
    }
    return toolpath;
}

voxelize::Lattice latticeOf(const Toolpath& toolpath, double edge) {
    voxelize::LatticeRequest request;
    request.voxel_size = edge;
    voxelize::Bounds bounds;
    bounds.include({{-1, -1, 0}, {10, 10, 2}});
    return voxelize::chooseLattice(toolpath, test::allBeads(toolpath), bounds, request);
}

CubeShares sharesOf(const Toolpath& toolpath, double edge) {
    return cubeShares(toolpath, test::allBeads(toolpath), latticeOf(toolpath, edge), {});
}

class CubeSharesOf : public testing::TestWithParam<double> {};

// Against points in every cube.
TEST_P(CubeSharesOf, AreThoseOfThePlainField) {
    const Toolpath toolpath = sparse();
    const double edge = GetParam();
    const CubeShares cubes = sharesOf(toolpath, edge);
    const test::PlainField field(toolpath);
    const int points = static_cast<int>(std::ceil(edge / 0.03));
    double worst = 0;
    double sum = 0;
    double expected = 0;
    for (std::size_t n = 0; n < cubes.list.size(); n += 1 + cubes.list.size() / 1000) {
        const CubeShare& cube = cubes.list[n];
        int inside = 0;
        const auto at = [&](int place, int point, int axis) {
            return cubes.origin[axis] + (place + (point + 0.4567) / points) * edge;
        };
        for (int x = 0; x < points; ++x)
            for (int y = 0; y < points; ++y)
                for (int z = 0; z < points; ++z)
                    inside += field(at(cube.i, x, 0), at(cube.j, y, 1), at(cube.k, z, 2)) < 0 ? 1 : 0;
        const double share = inside / std::pow(points, 3);
        worst = std::max(worst, std::abs(share - static_cast<double>(cube.share)));
        sum += static_cast<double>(cube.share);
        expected += share;
    }
    EXPECT_NEAR(sum / expected, 1, 0.01);
    EXPECT_LT(worst, edge < 0.15 ? 0.4 : 0.15);
}

TEST_P(CubeSharesOf, AddUpToTheSolid) {
    const Toolpath toolpath = sparse();
    const CubeShares fine = sharesOf(toolpath, 0.025);
    const CubeShares cubes = sharesOf(toolpath, GetParam());
    const double solid = fine.plastic * std::pow(0.025, 3);
    EXPECT_NEAR(cubes.plastic * std::pow(GetParam(), 3) / solid, 1, 0.005);
    double sum = 0;
    for (const CubeShare& cube : cubes.list) sum += static_cast<double>(cube.share);
    EXPECT_NEAR(sum / cubes.plastic, 1, 1e-5);
}

// A quarter of a layer to four layers, and what divides no layer.
INSTANTIATE_TEST_SUITE_P(Edges, CubeSharesOf, testing::Values(0.05, 0.1, 0.13, 0.2, 0.4, 0.53, 0.8));

// Where two layers touch, nothing is missing: lines that cross touch in their flats alone.
TEST(CubeShares, OfCrossingLinesReachTheFaceBetweenThem) {
    Toolpath toolpath;
    test::addBead(toolpath, -2, 0, 0.2, 2, 0, 0.2, 0.6, 0.2);
    test::addBead(toolpath, 0, -2, 0.4, 0, 2, 0.4, 0.6, 0.2);
    const CubeShares cubes = sharesOf(toolpath, 0.2);
    std::map<std::tuple<int, int, int>, CubeShare> at;
    for (const CubeShare& cube : cubes.list) at[{cube.i, cube.j, cube.k}] = cube;
    EXPECT_NEAR((at[{0, 0, 0}].share), 1, 1e-3);
    EXPECT_NEAR((at[{0, 0, 1}].share), 1, 1e-3);
    EXPECT_TRUE((at[{0, 0, 0}].reached >> z_high & 1) != 0);
    EXPECT_TRUE((at[{0, 0, 1}].reached >> z_low & 1) != 0);
}

TEST(CubeShares, DoNotDependOnTheNumberOfThreads) {
    const Toolpath toolpath = sparse();
    const auto with = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return sharesOf(toolpath, 0.3);
    };
    const CubeShares one = with(1);
    const CubeShares many = with(4);
    ASSERT_EQ(one.list.size(), many.list.size());
    EXPECT_EQ(one.plastic, many.plastic);
    for (std::size_t n = 0; n < one.list.size(); ++n) {
        const CubeShare& a = one.list[n];
        const CubeShare& b = many.list[n];
        ASSERT_EQ(std::tie(a.i, a.j, a.k, a.share, a.reached), std::tie(b.i, b.j, b.k, b.share, b.reached));
    }
}

}  // namespace
}  // namespace stratum::mechanics
