#include "voxelize/grid/solid_check.h"

#include "toolpaths.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <cmath>
#include <numbers>
#include <random>

namespace stratum::voxelize {
namespace {

using test::addBead;
using test::allBeads;

Lattice latticeOfVoxel(double voxel) {
    Lattice lattice;
    lattice.voxel_size = voxel;
    return lattice;
}

TEST(EnclosedVolume, OfOneBead) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 2, 40, 0, 2, 3, 2);
    const auto grid = voxelize(toolpath, allBeads(toolpath), latticeOfVoxel(0.1));
    // The straight part and the two round ends, which together are half a flattened torus: a disc of radius c, swept by
    // the half circle, by Pappus.
    const double c = 0.5;
    const double r = 1;
    const double ends = std::numbers::pi * c * c * 2 * r +
                        std::numbers::pi * r * r / 2 * 2 * std::numbers::pi * (c + 4 * r / (3 * std::numbers::pi));
    const double exact = 40 * gcode::sectionArea(3, 2) + ends;
    EXPECT_NEAR(enclosedVolume(*grid), exact, 1e-3 * exact);
}

TEST(EnclosedVolume, OfASphereInAnyTransform) {
    const auto sphere = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(10, openvdb::Vec3f(0.3F), 0.5F);
    const double exact = 4000.0 / 3 * std::numbers::pi;
    // Trilinear cells cut a convex surface a little short: by h^2 / r^2 and less.
    EXPECT_NEAR(enclosedVolume(*sphere), exact, 2.5e-3 * exact);
    sphere->transform().postScale(openvdb::Vec3d(2, 3, 0.5));
    EXPECT_NEAR(enclosedVolume(*sphere), 3 * exact, 2.5e-3 * 3 * exact);
}

// Inside, near the planes where layers touch, values are small: they say nothing about how much of a voxel is solid.
TEST(EnclosedVolume, OfWeldedLayersGoesToThatOfTheUnion) {
    gcode::Toolpath toolpath;
    constexpr double kEdge = 4;
    for (int layer = 0; layer < 8; ++layer)
        for (double at = 0; at <= kEdge; at += 0.407) {
            const double z = 0.2 * (layer + 1);
            const auto number = static_cast<std::uint32_t>(layer + 1);
            if (layer % 2 == 0)
                addBead(toolpath, 0, at, z, kEdge, at, z, 0.45, 0.2, number);
            else
                addBead(toolpath, at, 0, z, at, kEdge, z, 0.45, 0.2, number);
        }
    const test::BruteForce brute(toolpath);
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> plan(-0.3, kEdge + 0.3);
    std::uniform_real_distribution<double> height(0, 1.6);
    constexpr int kPoints = 400000;
    int inside = 0;
    for (int n = 0; n < kPoints; ++n) inside += brute(plan(random), plan(random), height(random)) < 0 ? 1 : 0;
    const double box = (kEdge + 0.6) * (kEdge + 0.6) * 1.6;
    const double share = static_cast<double>(inside) / kPoints;
    const double sigma = std::sqrt(share * (1 - share) / kPoints) * box;
    // Where a round side meets a flat, air thins out to a cusp, x^2 / 2r high. What is thinner than a voxel no sample
    // finds: h^(3/2) of area a cusp, counted as solid.
    double off[2] = {};
    for (int n = 0; n < 2; ++n) {
        Lattice lattice = latticeOfVoxel(n == 0 ? 0.05 : 0.0125);
        lattice.layer_height = 0.2;
        off[n] = enclosedVolume(*voxelize(toolpath, allBeads(toolpath), lattice)) / (share * box) - 1;
    }
    const double noise = 4 * sigma / (share * box);
    EXPECT_LT(std::abs(off[1]), 0.01 + noise);
    EXPECT_LT(std::abs(off[1]), std::abs(off[0]) / 4 + noise);
}

}  // namespace
}  // namespace stratum::voxelize
