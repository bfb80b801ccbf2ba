#include "march/file/grid_axes.h"

#include "base/error.h"
#include "march/brick/brick_intersector.h"
#include "march/file/level_set_file.h"
#include "march/reference/reference_intersectors.h"
#include "random_rays.h"
#include "refusal.h"
#include "rubble.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <functional>
#include <string>

namespace stratum::march {
namespace {

using Mat4 = openvdb::math::Mat4d;

constexpr float kVoxel = 0.1F;

// The same tree with `placed` after its own transform. Its values are scaled by `unit`, as a change of unit does.
openvdb::FloatGrid::Ptr placedRubble(const Mat4& placed, float unit = 1) {
    const auto grid = test::rubble(kVoxel, false);
    if (unit != 1) {
        for (auto it = grid->beginValueAll(); it; ++it) it.setValue(*it * unit);
        grid->tree().root().setBackground(grid->background() * unit, false);
    }
    grid->transform().postMult(placed);
    return grid;
}

Mat4 turned(double x, double y, double z) {
    Mat4 m = Mat4::identity();
    m.postRotate(openvdb::math::X_AXIS, x);
    m.postRotate(openvdb::math::Y_AXIS, y);
    m.postRotate(openvdb::math::Z_AXIS, z);
    return m;
}

Mat4 scaled(double x, double y, double z) {
    Mat4 m = Mat4::identity();
    m.postScale(openvdb::Vec3d(x, y, z));
    return m;
}

glm::dvec3 toGlm(const openvdb::Vec3d& v) { return {v[0], v[1], v[2]}; }
openvdb::Vec3d toVdb(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

struct Compared {
    int hits = 0, other = 0, loose = 0;
};

// Rays at the rubble as it is, and at the rubble placed by m, must meet the same points. Hits differ by less than
// `near` voxels but for `loose` ones; normals are then those of the placed surface.
Compared compare(const trace::Intersector& plain, const trace::Intersector& placed, const Mat4& m, double near) {
    const Mat4 inverse = m.inverse();
    const auto plain_tracer = plain.makeTracer();
    const auto placed_tracer = placed.makeTracer();
    Compared sum;
    std::mt19937 random(11);
    std::uniform_real_distribution<double> where(-4, 4);
    for (int n = 0; n < 20000; ++n) {
        // From outside, from within, and from far away. None along lattice planes: there rounding chooses the cell.
        trace::Ray ray;
        ray.origin = n % 3 == 0 ? glm::dvec3(where(random), where(random), where(random))
                                : (n % 5 == 0 ? 1e4 : 20.0) * test::randomDirection(random);
        ray.direction = glm::normalize(glm::dvec3(where(random), where(random), where(random)) - ray.origin);
        if (n % 7 == 0) ray.t_min = 0.5 * glm::length(ray.origin);
        if (n % 11 == 0) ray.t_max = glm::length(ray.origin);
        const openvdb::Vec3d way = m.transform3x3(toVdb(ray.direction));
        const double stretch = way.length();
        trace::Ray other;
        other.origin = toGlm(m.transform(toVdb(ray.origin)));
        other.direction = toGlm(way / stretch);
        other.t_min = ray.t_min * stretch;
        other.t_max = ray.t_max * stretch;
        trace::Hit hit;
        trace::Hit moved;
        const bool found = plain_tracer->intersect(ray, hit);
        const bool found_moved = placed_tracer->intersect(other, moved);
        EXPECT_EQ(placed_tracer->occluded(other), found_moved);
        if (found != found_moved) {
            ++sum.other;
            continue;
        }
        if (!found) continue;
        ++sum.hits;
        EXPECT_NEAR(glm::length(moved.position - (other.origin + moved.t * other.direction)), 0,
                    1e-9 * (1 + glm::length(other.origin)));
        if (std::abs(moved.t / stretch - hit.t) > near * static_cast<double>(kVoxel)) {
            ++sum.loose;
            continue;
        }
        // Gradients go by the inverse transpose.
        const openvdb::Vec3d normal = inverse.transpose().transform3x3(toVdb(hit.normal)).unit();
        const double turn = glm::dot(moved.normal, toGlm(normal));
        // A hit that is not exact may lie in the next cell, which leans another way.
        if (turn < (near < 1e-6 ? 1 - 1e-6 : 0.95)) ++sum.loose;
    }
    return sum;
}

struct Placing {
    const char* name;
    Mat4 map;
    float unit;
};

std::vector<Placing> placings() {
    Mat4 away = turned(0.3, -1.1, 2.0);
    away.setTranslation(openvdb::Vec3d(120, -30, 7));
    return {{"y up", turned(-std::acos(-1.0) / 2, 0, 0), 1},
            {"turned and moved", away, 1},
            {"scaled per axis", scaled(1, 1.7, 0.6), 1},
            {"scaled per axis and turned", scaled(2.5, 1, 0.8) * turned(0.2, 0.9, -0.4), 1},
            {"mirrored", scaled(-1, 1, 1), 1},
            {"metres, y up", scaled(1e-3, 1e-3, 1e-3) * turned(-std::acos(-1.0) / 2, 0, 0), 1e-3F}};
}

TEST(GridAxes, MeasuresVoxels) {
    const auto upright = openvdb::math::Transform::createLinearTransform(0.25);
    const GridAxes cube(*upright);
    EXPECT_DOUBLE_EQ(cube.shortest(), 0.25);
    EXPECT_DOUBLE_EQ(cube.longest(), 0.25);
    EXPECT_EQ(cube.shear(), 0);
    upright->postScale(openvdb::Vec3d(1, 2, 8));
    upright->postRotate(0.7, openvdb::math::Y_AXIS);
    const GridAxes box(*upright);
    EXPECT_NEAR(box.shortest(), 0.25, 1e-15);
    EXPECT_NEAR(box.longest(), 2, 1e-15);
    EXPECT_LT(box.shear(), 1e-15);
    upright->postShear(0.5, openvdb::math::X_AXIS, openvdb::math::Y_AXIS);
    EXPECT_GT(GridAxes(*upright).shear(), 0.01);
}

TEST(GridAxes, BrickMeetsTheSamePointsWhereverTheGridIsPut) {
    const auto plain = makeBrickIntersector(*placedRubble(Mat4::identity()));
    for (const Placing& placing : placings()) {
        SCOPED_TRACE(placing.name);
        const auto placed = makeBrickIntersector(*placedRubble(placing.map, placing.unit));
        // Exact in both places, but for the rounding of rays from far away, and of values in another unit.
        const Compared sum = compare(*plain, *placed, placing.map, placing.unit == 1 ? 1e-7 : 1e-4);
        EXPECT_GT(sum.hits, 5000);
        EXPECT_LE(sum.other, 4);
        EXPECT_LE(sum.loose, 2) << sum.hits;
    }
}

TEST(GridAxes, StreamsMeetThemToo) {
    for (const Placing& placing : placings()) {
        SCOPED_TRACE(placing.name);
        const auto placed = makeBrickIntersector(*placedRubble(placing.map, placing.unit));
        const auto tracer = placed->makeTracer();
        std::vector<trace::Ray> rays = test::randomRays(4000, 4.0, static_cast<double>(kVoxel), 3);
        for (trace::Ray& ray : rays) {
            ray.origin = toGlm(placing.map.transform(toVdb(ray.origin)));
            ray.direction = toGlm(placing.map.transform3x3(toVdb(ray.direction)).unit());
        }
        std::vector<trace::Hit> hits(rays.size());
        tracer->intersectStream(rays, hits);
        for (std::size_t n = 0; n < rays.size(); ++n) {
            trace::Hit hit;
            if (!tracer->intersect(rays[n], hit)) {
                ASSERT_FALSE(std::isfinite(hits[n].t));
                continue;
            }
            ASSERT_EQ(hits[n].t, hit.t);
            ASSERT_EQ(hits[n].normal, hit.normal);
        }
    }
}

TEST(GridAxes, TheReferenceMeetsThemToo) {
    const auto plain = makeVdbIntersector(placedRubble(Mat4::identity()));
    for (const Placing& placing : placings()) {
        SCOPED_TRACE(placing.name);
        const auto placed = makeVdbIntersector(placedRubble(placing.map, placing.unit));
        const Compared sum = compare(*plain, *placed, placing.map, 1e-2);
        EXPECT_GT(sum.hits, 5000);
        // It looks at a voxel's faces only: in a wider band it may find a graze that it missed in a narrower one.
        EXPECT_LE(sum.other, sum.hits / 200);
        EXPECT_LE(sum.loose, sum.hits / 100);
    }
}

TEST(GridAxes, SphereTracingMeetsThemToo) {
    const auto plain = makeSphereIntersector(placedRubble(Mat4::identity()));
    for (const Placing& placing : placings()) {
        SCOPED_TRACE(placing.name);
        const auto placed = makeSphereIntersector(placedRubble(placing.map, placing.unit));
        const Compared sum = compare(*plain, *placed, placing.map, 1e-2);
        EXPECT_GT(sum.hits, 5000);
        EXPECT_LE(sum.other, sum.hits / 200);
        EXPECT_LE(sum.loose, sum.hits / 30);
    }
}

TEST(GridAxes, TracedLengthsAreWorldUnits) {
    // An ellipsoid on paper: a ball of radius 2 in a grid that is stretched to 3 in y and squashed to 0.5 in z.
    Mat4 m = scaled(1, 3, 0.5);
    const auto grid = test::sphereGrid(2, openvdb::Vec3f(0), 0.05F);
    grid->transform().postMult(m);
    for (const auto& shape : {makeBrickIntersector(*grid), makeVdbIntersector(grid), makeSphereIntersector(grid)}) {
        SCOPED_TRACE(std::string(shape->name()));
        const auto tracer = shape->makeTracer();
        trace::Hit hit;
        ASSERT_TRUE(tracer->intersect({{0, -20, 0}, {0, 1, 0}}, hit));
        EXPECT_NEAR(hit.t, 14, 5e-3);
        ASSERT_TRUE(tracer->intersect({{0, 0, 10}, {0, 0, -1}}, hit));
        EXPECT_NEAR(hit.t, 9, 5e-3);
        ASSERT_TRUE(tracer->intersect({{-9, 3, 0}, {1, 0, 0}}, hit));
        EXPECT_NEAR(hit.position.x, -std::sqrt(3.0), 5e-3);
        const glm::dvec3 normal = glm::normalize(glm::dvec3(hit.position.x, hit.position.y / 9, 0));
        EXPECT_GT(glm::dot(hit.normal, normal), 0.999);
        EXPECT_NEAR(shape->voxelSize(), 0.025, 1e-9);
        EXPECT_LT(shape->surfaceOffset(), 0.0026);
        const trace::Box box = shape->bounds();
        EXPECT_NEAR(box.max.y, 6.4, 0.1);
        EXPECT_NEAR(box.max.z, 1.07, 0.03);
    }
}

std::string refusal(const openvdb::FloatGrid& grid) {
    return test::messageOf<InputError>([&] { requireTraceable(grid, "there"); }, "(none)");
}

TEST(GridAxes, ShearAndPerspectiveAreRefused) {
    auto grid = test::sphereGrid(2, openvdb::Vec3f(0), 0.1F);
    grid->transform().postShear(0.1, openvdb::math::X_AXIS, openvdb::math::Y_AXIS);
    EXPECT_NE(refusal(*grid).find("sheared: their edges are 5.711 degrees"), std::string::npos) << refusal(*grid);
    grid->setTransform(openvdb::math::Transform::createFrustumTransform(
        openvdb::BBoxd(openvdb::Vec3d(0), openvdb::Vec3d(10)), 0.5, 1, 0.1));
    EXPECT_NE(refusal(*grid).find("perspective"), std::string::npos) << refusal(*grid);
    // Turned by 32-bit numbers, as some programs write them: that is no shear.
    grid = test::sphereGrid(2, openvdb::Vec3f(0), 0.1F);
    const auto c = static_cast<double>(std::cos(0.7F));
    const auto s = static_cast<double>(std::sin(0.7F));
    grid->transform().postMult(Mat4(c, s, 0.0, 0.0, -s, c + 1e-7, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0));
    EXPECT_EQ(refusal(*grid), "(none)");
}

TEST(GridAxes, TheBandIsMeasuredByTheShortestEdge) {
    const auto grid = test::sphereGrid(2, openvdb::Vec3f(0), 0.1F, 3);
    grid->transform().postScale(2.0);  // the values were not scaled with it
    EXPECT_NE(refusal(*grid).find("1.50 voxels"), std::string::npos) << refusal(*grid);
    const auto tall = test::sphereGrid(2, openvdb::Vec3f(0), 0.1F, 3);
    tall->transform().postScale(openvdb::Vec3d(1, 1, 4));
    EXPECT_EQ(refusal(*tall), "(none)");
}

}  // namespace
}  // namespace stratum::march
