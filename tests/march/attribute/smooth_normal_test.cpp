#include "march/attribute/annotation.h"

#include "march/brick/brick_intersector.h"
#include "random_rays.h"
#include "spheres.h"

#include <gtest/gtest.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <glm/geometric.hpp>

#include <cmath>
#include <numbers>

namespace stratum::march {
namespace {

double degreesBetween(const glm::dvec3& a, const glm::dvec3& b) {
    return std::acos(std::min(1.0, glm::dot(a, b))) * 180 / std::numbers::pi;
}

TEST(SmoothNormal, IsBetterThanTheCellsOnASphere) {
    for (const bool placed : {false, true}) {
        const auto grid = test::sphereGrid(2, openvdb::Vec3f(0), 0.1F);
        const glm::dvec3 center(placed ? 50 : 0, 0, 0);
        if (placed) {
            grid->transform().postRotate(0.7, openvdb::math::Y_AXIS);
            grid->transform().postTranslate(openvdb::Vec3d(50, 0, 0));
        }
        const auto shape = makeBrickIntersector(*grid);
        const auto tracer = shape->makeTracer();
        SmoothNormal smooth(*grid);
        std::mt19937 random(1);
        double cell_sum = 0;
        double smooth_sum = 0;
        double worst = 0;
        for (int n = 0; n < 5000; ++n) {
            const glm::dvec3 from = center + 9.0 * test::randomDirection(random);
            trace::Hit hit;
            ASSERT_TRUE(tracer->intersect({from, glm::normalize(center + test::randomDirection(random) - from)}, hit));
            const glm::dvec3 truth = glm::normalize(hit.position - center);
            const glm::dvec3 s = smooth.at(hit.position, hit.normal);
            EXPECT_NEAR(glm::length(s), 1, 1e-12);
            cell_sum += degreesBetween(hit.normal, truth);
            smooth_sum += degreesBetween(s, truth);
            worst = std::max(worst, degreesBetween(s, truth));
        }
        EXPECT_LT(smooth_sum, 0.1 * cell_sum) << smooth_sum / 5000 << " of " << cell_sum / 5000;
        EXPECT_LT(worst, 0.5);
    }
}

// Two beads of height h on one another, along y: round flanks that meet in a crease on a plane of voxels.
double beads(double x, double z, double h, double c) {
    double d = 1e9;
    for (const double middle : {-0.5 * h, 0.5 * h})
        d = std::min(d, std::hypot(std::max(std::abs(x) - c, 0.0), z - middle) - 0.5 * h);
    return d;
}

TEST(SmoothNormal, DoesNotBlurACrease) {
    constexpr double kHeight = 0.2;
    constexpr double kCore = 1.0;
    const double voxel = kHeight / 8;
    auto grid = openvdb::FloatGrid::create(static_cast<float>(3 * voxel));
    auto accessor = grid->getAccessor();
    for (int x = -60; x <= 60; ++x)
        for (int y = 0; y < 16; ++y)
            for (int z = -16; z <= 16; ++z) {
                const double d = beads(x * voxel, z * voxel, kHeight, kCore);
                if (std::abs(d) < 3 * voxel) accessor.setValue(openvdb::Coord(x, y, z), static_cast<float>(d));
            }
    openvdb::tools::signedFloodFill(grid->tree());
    grid->setName("surface");
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
    const auto shape = makeBrickIntersector(*grid);
    const auto tracer = shape->makeTracer();
    SmoothNormal smooth(*grid);
    double near_cell = 0;
    double near_smooth = 0;
    double far_cell = 0;
    double far_smooth = 0;
    int near = 0;
    int far = 0;
    for (int n = -3000; n < 3000; ++n) {
        // Not 0: on the plane where the two touch there is a crack of no thickness.
        const double z = (n + 0.5) * 0.9 * kHeight / 3000;
        trace::Hit hit;
        ASSERT_TRUE(tracer->intersect({{4, 0.21, z}, {-1, 0, 0}}, hit)) << z;
        const double middle = z > 0 ? 0.5 * kHeight : -0.5 * kHeight;
        const glm::dvec3 truth = glm::normalize(glm::dvec3(std::max(hit.position.x - kCore, 0.0), 0, z - middle));
        const double cell = degreesBetween(hit.normal, truth);
        const double s = degreesBetween(smooth.at(hit.position, hit.normal), truth);
        // Within a voxel of the crease the normal is that of the own side, as good as the cell's; blurred it would be
        // 45 degrees off and more.
        if (std::abs(z) < voxel) {
            ++near;
            near_cell += cell;
            near_smooth += s;
        } else if (std::abs(z) > 2 * voxel && std::abs(z) < 6 * voxel) {
            ++far;
            far_cell += cell;
            far_smooth += s;
        }
    }
    EXPECT_LT(near_smooth / near, near_cell / near + 1.0) << near_cell / near;
    EXPECT_LT(far_smooth / far, 0.5 * far_cell / far) << far_smooth / far;
    EXPECT_LT(far_smooth / far, 1.0);
}

}  // namespace
}  // namespace stratum::march
