#include "export/mesh/mesh_simplify.h"

#include "closed_mesh.h"
#include "toolpaths.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace stratum::exporter {
namespace {

using test::addArc;
using test::addBead;
using test::allBeads;

// Largest and mean |distance| of points spread over the faces.
template <typename Distance>
std::pair<double, double> distances(const SurfaceMesh& mesh, const Distance& distance) {
    double largest = 0;
    double sum = 0;
    double area = 0;
    mesh.forEachTriangle([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        const openvdb::Vec3d p(mesh.points[a]);
        const openvdb::Vec3d q(mesh.points[b]);
        const openvdb::Vec3d r(mesh.points[c]);
        const double weight = (q - p).cross(r - p).length();
        constexpr int kParts = 6;
        double mean = 0;
        for (int i = 0; i <= kParts; ++i)
            for (int j = 0; i + j <= kParts; ++j) {
                const double d = std::abs(distance(p + (q - p) * (1.0 * i / kParts) + (r - p) * (1.0 * j / kParts)));
                largest = std::max(largest, d);
                mean += d / ((kParts + 1) * (kParts + 2) / 2);
            }
        sum += mean * weight;
        area += weight;
    });
    return {largest, sum / area};
}

TEST(MeshSimplify, ASphereStaysWithinTheError) {
    openvdb::initialize();
    constexpr double kVoxel = 0.1;
    const auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(
        4.0F, openvdb::Vec3f(0.01F, 0.02F, 0.03F), static_cast<float>(kVoxel));
    const auto off = [](const openvdb::Vec3d& p) { return (p - openvdb::Vec3d(0.01, 0.02, 0.03)).length() - 4.0; };
    const SurfaceMesh all = meshSurface(*grid);
    std::size_t last = all.triangleCount();
    for (const double error : {0.1, 0.25, 0.5}) {
        const SurfaceMesh mesh = meshSurface(*grid, {false, error});
        test::expectClosed(mesh);
        EXPECT_LT(distances(mesh, off).first, (1.2 * error + 0.05) * kVoxel) << error;
        EXPECT_LT(mesh.triangleCount(), 2 * last / 3) << error;
        EXPECT_NEAR(mesh.volume(), 4.0 / 3.0 * std::numbers::pi * 64, 4 * std::numbers::pi * 16 * error * kVoxel);
        last = mesh.triangleCount();
    }
    EXPECT_LT(last, all.triangleCount() / 10);
}

// Straight and round walls of layers, at four voxels a layer.
TEST(MeshSimplify, APrintHasATenthOfTheFacesWithinAQuarterVoxel) {
    openvdb::initialize();
    gcode::Toolpath toolpath;
    for (int layer = 0; layer < 8; ++layer) {
        const double z = 0.2 * (layer + 1);
        const auto number = static_cast<std::uint32_t>(layer + 1);
        const double corners[4][2] = {{0, 1}, {9, 0}, {10, 8}, {1, 9}};
        for (int n = 0; n < 4; ++n)
            addBead(toolpath, corners[n][0], corners[n][1], z, corners[(n + 1) % 4][0], corners[(n + 1) % 4][1], z,
                    0.45, 0.2, number);
        addArc(toolpath, 5, 4.5, 2, 0.2, 2 * std::numbers::pi, z, z, 0.45, 0.2, number);
    }
    voxelize::Lattice lattice;
    lattice.voxel_size = 0.05;
    lattice.layer_height = 0.2;
    const auto grid = voxelize::voxelize(toolpath, allBeads(toolpath), lattice);
    const SurfaceMesh all = meshSurface(*grid);
    const SurfaceMesh mesh = meshSurface(*grid, {false, 0.25});
    test::expectClosed(mesh);
    EXPECT_LT(mesh.triangleCount(), all.triangleCount() / 10);
    EXPECT_NEAR(mesh.volume(), all.volume(), 0.01 * all.volume());
    // Beside the full mesh's own distance from the level set.
    const auto accessor = grid->getConstAccessor();
    const auto off = [&](const openvdb::Vec3d& p) {
        return std::max(0.0, static_cast<double>(openvdb::tools::BoxSampler::sample(accessor, grid->worldToIndex(p))));
    };
    const auto [exact_largest, exact_mean] = distances(all, off);
    const auto [largest, mean] = distances(mesh, off);
    EXPECT_LT(largest, exact_largest + 0.3 * lattice.voxel_size);
    EXPECT_LT(mean, exact_mean + 0.05 * lattice.voxel_size);
    RecordProperty("triangles", std::to_string(all.triangleCount()) + " -> " + std::to_string(mesh.triangleCount()));
}

TEST(MeshSimplify, ColorsKeepTheirBorder) {
    openvdb::initialize();
    constexpr double kVoxel = 0.1;
    const auto grid =
        openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(2.0F, openvdb::Vec3f(0), static_cast<float>(kVoxel));
    const auto color = openvdb::Vec3SGrid::create();
    color->setTransform(grid->transform().copy());
    color->topologyUnion(*grid);
    for (auto voxel = color->beginValueOn(); voxel; ++voxel)
        voxel.setValue(voxel.getCoord().z() < 3 ? openvdb::Vec3f(1, 0, 0) : openvdb::Vec3f(0, 0, 1));
    const SurfaceMesh mesh = meshSurface(*grid, {false, 0.5, 0, color.get()});
    test::expectClosed(mesh);
    ASSERT_EQ(mesh.material_of_point.size(), mesh.points.size());
    ASSERT_EQ(mesh.materials.size(), 2U);
    EXPECT_EQ(mesh.materials[0].name, "color_0000ff");
    EXPECT_EQ(mesh.materials[1].name, "color_ff0000");
    for (std::size_t n = 0; n < mesh.points.size(); ++n) {
        const bool red = mesh.materials[mesh.material_of_point[n]].color == std::array<std::uint8_t, 3>{255, 0, 0};
        if (std::abs(mesh.points[n][2] - 0.25F) > 0.05F) {
            EXPECT_EQ(red, mesh.points[n][2] < 0.25F) << mesh.points[n];
        }
    }
    // The border is a strip one voxel wide, not wider: faces with both colors are small.
    const auto& of = mesh.material_of_point;
    mesh.forEachTriangle([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        if (of[a] == of[b] && of[b] == of[c]) return;
        for (const std::uint32_t point : {a, b, c}) EXPECT_NEAR(mesh.points[point][2], 0.25, 2.5 * kVoxel);
    });
    EXPECT_LT(mesh.triangleCount(), meshSurface(*grid).triangleCount() / 3);
}

}  // namespace
}  // namespace stratum::exporter
