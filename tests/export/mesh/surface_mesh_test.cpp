#include "export/mesh/surface_mesh.h"

#include "closed_mesh.h"

#include <gtest/gtest.h>
#include <openvdb/tools/Composite.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>
#include <utility>

namespace stratum::exporter {
namespace {

constexpr double kPi = std::numbers::pi;

// A narrow band of a shape around the origin, in a box of `reach` voxels to each side.
openvdb::FloatGrid::Ptr levelSet(int reach, double voxel,
                                 const std::function<double(const openvdb::Vec3d&)>& distance) {
    const auto background = static_cast<float>(3 * voxel);
    auto grid = openvdb::FloatGrid::create(background);
    grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    auto tree = grid->getAccessor();
    for (int x = -reach; x <= reach; ++x)
        for (int y = -reach; y <= reach; ++y)
            for (int z = -reach; z <= reach; ++z) {
                const auto value = static_cast<float>(distance(voxel * openvdb::Vec3d(x, y, z)));
                if (std::abs(value) < background)
                    tree.setValue({x, y, z}, value);
                else
                    tree.setValueOff({x, y, z}, std::copysign(background, value));
            }
    return grid;
}

double box(const openvdb::Vec3d& p, const openvdb::Vec3d& half) {
    const openvdb::Vec3d q(std::abs(p[0]) - half[0], std::abs(p[1]) - half[1], std::abs(p[2]) - half[2]);
    const openvdb::Vec3d out(std::max(q[0], 0.0), std::max(q[1], 0.0), std::max(q[2], 0.0));
    return out.length() + std::min(std::max({q[0], q[1], q[2]}), 0.0);
}

double torus(const openvdb::Vec3d& p, double radius, double tube) {
    return std::hypot(std::hypot(p[0], p[1]) - radius, p[2]) - tube;
}

// V - E + F: 2 - 2 * genus for a connected surface.
int eulerCharacteristic(const SurfaceMesh& mesh) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    mesh.forEachTriangle([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        for (const auto& [p, q] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}})
            edges.insert({std::min(p, q), std::max(p, q)});
    });
    return static_cast<int>(mesh.points.size()) - static_cast<int>(edges.size()) +
           static_cast<int>(mesh.triangleCount());
}

}  // namespace

TEST(SurfaceMesh, VolumeOfASphereConvergesWithTheSecondOrder) {
    double last = 0;
    for (const double voxel : {0.2, 0.1, 0.05}) {
        const auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(
            1.0F, openvdb::Vec3f(0.013F, 0.021F, 0.037F), static_cast<float>(voxel));
        const SurfaceMesh mesh = meshSurface(*grid);
        test::expectClosed(mesh);
        EXPECT_EQ(eulerCharacteristic(mesh), 2);
        const double error = std::abs(mesh.volume() / (4.0 / 3.0 * kPi) - 1.0);
        EXPECT_LT(error, 1.25 * voxel * voxel);
        if (last > 0) {
            EXPECT_LT(error, last / 3);
        }
        last = error;
    }
}

TEST(SurfaceMesh, KeepsTheGenus) {
    const double voxel = 0.1;
    for (const double error : {0.0, 0.25, 0.5}) {
        const auto ring = levelSet(16, voxel, [](const auto& p) { return torus(p, 1.0, 0.35); });
        const SurfaceMesh one = meshSurface(*ring, {false, error});
        test::expectClosed(one);
        EXPECT_EQ(eulerCharacteristic(one), 0);
        // Points lie inside of what they approximate: the tube is only 7 voxels thick.
        const double exact = 2 * kPi * kPi * 1.0 * 0.35 * 0.35;
        EXPECT_NEAR(one.volume(), exact, (error < 0.3 ? 0.06 : 0.1) * exact);
        const auto rings = levelSet(24, voxel, [](const auto& p) {
            return std::min(torus(p - openvdb::Vec3d(0.95, 0, 0), 1.0, 0.3),
                            torus(p + openvdb::Vec3d(0.95, 0, 0), 1.0, 0.3));
        });
        const SurfaceMesh two = meshSurface(*rings, {false, error});
        test::expectClosed(two);
        // Where the rings overlap they fill the lens between them; the two other holes stay.
        EXPECT_EQ(eulerCharacteristic(two), 2 - 2 * 2);
    }
}

TEST(SurfaceMesh, FacesOnSamplesGiveNoFlatFaces) {
    // All six sides lie on samples, which are exactly 0 there.
    const auto grid = levelSet(12, 0.5, [](const auto& p) { return box(p, {4, 3, 2}); });
    for (const double error : {0.0, 0.25}) {
        const SurfaceMesh mesh = meshSurface(*grid, {false, error});
        test::expectClosed(mesh);
        EXPECT_EQ(eulerCharacteristic(mesh), 2);
        EXPECT_NEAR(mesh.volume(), 8 * 6 * 4, 3);
    }
}

TEST(SurfaceMesh, ASheetOfZerosInsideASolidIsNoSurface) {
    // Two boxes that touch: between them lie samples of exactly 0.
    const auto grid = levelSet(14, 0.5, [](const auto& p) {
        return std::min(box(p - openvdb::Vec3d(0, 0, 2), {3, 3, 2}), box(p + openvdb::Vec3d(0, 0, 2), {3, 3, 2}));
    });
    const SurfaceMesh mesh = meshSurface(*grid);
    test::expectClosed(mesh);
    EXPECT_EQ(eulerCharacteristic(mesh), 2);
    EXPECT_NEAR(mesh.volume(), 6 * 6 * 8, 4);
}

TEST(SurfaceMesh, CavitiesGoOnRequest) {
    const auto grid = levelSet(25, 0.1, [](const auto& p) { return std::max(p.length() - 2.0, 1.0 - p.length()); });
    const SurfaceMesh both = meshSurface(*grid);
    test::expectClosed(both);
    EXPECT_EQ(eulerCharacteristic(both), 4);
    EXPECT_NEAR(both.volume(), 4.0 / 3.0 * kPi * 7.0, 0.1);
    const SurfaceMesh outside = meshSurface(*grid, {true, 0.0});
    test::expectClosed(outside);
    EXPECT_EQ(eulerCharacteristic(outside), 2);
    EXPECT_NEAR(outside.volume(), 4.0 / 3.0 * kPi * 8.0, 0.1);
}

TEST(SurfaceMesh, HasNoMoreTrianglesThanAskedFor) {
    const auto grid = levelSet(40, 0.1, [](const openvdb::Vec3d& p) { return torus(p, 2.5, 0.8); });
    const SurfaceMesh all = meshSurface(*grid);
    EXPECT_EQ(all.error, 0);
    MeshOptions options;
    options.most_triangles = 1500;
    const SurfaceMesh few = meshSurface(*grid, options);
    EXPECT_GT(all.triangleCount(), 5000U);
    EXPECT_LE(few.triangleCount(), 1500U);
    EXPECT_GT(few.triangleCount(), 300U);
    EXPECT_GT(few.error, 0);
    EXPECT_EQ(eulerCharacteristic(few), 0);
    test::expectClosed(few);
    EXPECT_NEAR(few.volume() / all.volume(), 1, 0.03);
    // What hangs together stays so, however few are asked for.
    options.most_triangles = 1;
    EXPECT_EQ(eulerCharacteristic(meshSurface(*grid, options)), 0);
}

TEST(SurfaceMesh, OfNothingIsEmpty) {
    const SurfaceMesh mesh = meshSurface(*openvdb::FloatGrid::create(3.0F));
    EXPECT_TRUE(mesh.points.empty());
    EXPECT_EQ(mesh.triangleCount(), 0U);
    EXPECT_EQ(mesh.volume(), 0.0);
}

}  // namespace stratum::exporter
