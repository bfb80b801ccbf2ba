#include "trace/sdf_intersector.h"

#include "base/error.h"
#include "march/brick/brick_intersector.h"
#include "march/file/sdf_grid.h"
#include "random_rays.h"
#include "refusal.h"
#include "trace/scene_intersector.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <cmath>

namespace stratum::trace {
namespace {

SdfPtr machinePart() {
    const glm::dmat3 turned = Placement::of({1, 1, 1}, {15, 0, 30}, {0, 0, 0}).linear;
    return sdfMoved(sdfUnion({sdfSubtraction({sdfBox({0, 0, 0}, {1.5, 1, 0.8}), sdfCylinder({0, 0, 0}, 0.6, 2, 2)}),
                              sdfTorus({1.2, 0, 0.8}, 0.8, 0.3, 1), sdfSphere({-1.5, 0, 0.5}, 0.7)}),
                    turned, {0.1, 0.2, -0.3});
}

TEST(SdfIntersector, HitsASphereToRounding) {
    const auto shape = makeSdfIntersector(sdfSphere({1, 2, 3}, 2));
    const auto tracer = shape->makeTracer();
    std::mt19937 random(1);
    int hits = 0;
    for (int n = 0; n < 20000; ++n) {
        const glm::dvec3 center(1, 2, 3);
        Ray ray;
        ray.origin = center + 30.0 * test::randomDirection(random);
        ray.direction = glm::normalize(center + 2.5 * test::randomDirection(random) - ray.origin);
        const double along = glm::dot(center - ray.origin, ray.direction);
        const double miss = glm::length(center - ray.origin - along * ray.direction);
        Hit hit;
        const bool found = tracer->intersect(ray, hit);
        EXPECT_EQ(tracer->occluded(ray), found);
        // A chord of two steps may be stepped over.
        const double chord = miss < 2 ? 2 * std::sqrt(4 - miss * miss) : 0;
        EXPECT_TRUE(found || chord <= 2e-4) << chord;
        EXPECT_FALSE(found && chord == 0);
        if (!found) continue;
        ++hits;
        EXPECT_NEAR(hit.t, along - std::sqrt(4 - miss * miss), 1e-12 / std::max(chord, 1e-3));
        EXPECT_GT(glm::dot(hit.normal, glm::normalize(hit.position - center)), 1 - 1e-10);
    }
    EXPECT_GT(hits, 8000);
}

TEST(SdfIntersector, AgreesWithItsOwnVoxels) {
    const SdfPtr part = machinePart();
    const auto exact = makeSdfIntersector(part);
    const auto exact_tracer = exact->makeTracer();
    double last = 1e9;
    for (const double voxel : {0.08, 0.04, 0.02}) {
        const auto grid = march::makeSdfGrid(*part, voxel);
        const auto bricks = march::makeBrickIntersector(*grid);
        const auto tracer = bricks->makeTracer();
        int hits = 0;
        int differ = 0;
        int far = 0;
        double sum = 0;
        for (const Ray& ray : test::randomRays(20000, 2.5, voxel, 7)) {
            Hit a;
            Hit b;
            const bool found = exact_tracer->intersect(ray, a);
            if (tracer->intersect(ray, b) != found) {
                ++differ;
                continue;
            }
            if (!found) continue;
            ++hits;
            // The distance between the two surfaces at the hit, not along the ray.
            const double off = std::abs(part->distance(b.position));
            sum += off;
            if (off > 0.5 * voxel) ++far;
        }
        EXPECT_GT(hits, 3000);
        EXPECT_LE(differ, hits * voxel / 2) << voxel;  // silhouettes: in proportion to the voxel
        EXPECT_EQ(far, 0) << voxel;
        // At edges the error is of the first order, elsewhere of the second.
        EXPECT_LT(sum / hits, 0.45 * last) << voxel;
        last = sum / hits;
    }
    EXPECT_LT(last, 0.02 * 0.02);
}

TEST(SdfIntersector, RaysNeitherLeakNorHang) {
    const auto shape = makeSdfIntersector(machinePart());
    const auto tracer = shape->makeTracer();
    std::mt19937 random(2);
    int inside_hits = 0;
    int left = 0;
    int entered = 0;
    int met_twice = 0;
    for (const Ray& ray : test::randomRays(20000, 2.5, 0.1, 9)) {
        Hit hit;
        if (!tracer->intersect(ray, hit)) continue;
        // A ray that goes on inwards must come out.
        const double side = glm::dot(hit.normal, ray.direction) < 0 ? 1 : -1;
        Hit out;
        if (side > 0) {
            ++entered;
            if (tracer->intersect({hit.position - shape->surfaceOffset() * hit.normal, -hit.normal}, out))
                ++inside_hits;
        }
        ++left;
        // And one that leaves a place must not meet that place again.
        Ray away{hit.position + side * shape->surfaceOffset() * hit.normal,
                 glm::normalize(side * hit.normal + test::randomDirection(random))};
        if (tracer->intersect(away, out) && out.t < 1e-6) ++met_twice;
    }
    EXPECT_GT(left, 3000);
    EXPECT_EQ(inside_hits, entered);
    EXPECT_LE(met_twice, left / 1000);  // in creases
}

TEST(SdfIntersector, EndlessShapesAreTraced) {
    const auto field =
        makeSdfIntersector(sdfUnion({sdfPlane({0, 0, 1}, 0), sdfRepetition(sdfSphere({0, 0, 0}, 0.5), {2, 2, 0}, -1)}));
    const auto tracer = field->makeTracer();
    Hit hit;
    ASSERT_TRUE(tracer->intersect({{1, 1, 5}, {0, 0, -1}}, hit));
    EXPECT_NEAR(hit.t, 5, 1e-12);
    ASSERT_TRUE(tracer->intersect({{2000, 2000, 5}, {0, 0, -1}}, hit));
    EXPECT_NEAR(hit.t, 4.5, 1e-9);
    EXPECT_FALSE(tracer->intersect({{1, 1, 5}, {0, 0, 1}}, hit));
    EXPECT_FALSE(tracer->intersect({{1, 1, 5}, {1, 0, 0}}, hit));  // between the rows, for ever
    EXPECT_FALSE(tracer->intersect({{1, 1, 5}, {std::nan(""), 0, 1}}, hit));
    EXPECT_THROW(march::makeSdfGrid(*sdfPlane({0, 0, 1}, 0), 0.1), UsageError);
    EXPECT_THROW(march::makeSdfGrid(*sdfSphere({0, 0, 0}, 1), 0), UsageError);
    EXPECT_THROW(march::makeSdfGrid(*sdfSphere({0, 0, 0}, 1), 1e-9), UsageError);
    // Between the samples.
    EXPECT_THROW(march::makeSdfGrid(*sdfSphere({3, 3, 3}, 1), 10), UsageError);
    EXPECT_THROW(makeSdfIntersector(sdfSphere({0, 0, 0}, 1), 0), UsageError);
}

// A scene of a few bytes must not take all memory: what a grid needs is known before, by a factor of two.
TEST(SdfGrid, IsRefusedIfItWouldNotFit) {
    openvdb::initialize();
    const auto shape = sdfUnion({sdfSphere({0, 0, 0}, 1), sdfTorus({1, 0, 0}, 2, 0.3, 2)});
    for (const double voxel : {0.1, 0.03, 0.01}) {
        const auto bytes = static_cast<double>(march::makeSdfGrid(*shape, voxel)->memUsage());
        EXPECT_NO_THROW(march::makeSdfGrid(*shape, voxel, static_cast<std::size_t>(2 * bytes))) << voxel;
        EXPECT_TRUE(test::refuses<UsageError>("GB here; take a voxel_size of", [&] {
            march::makeSdfGrid(*shape, voxel, static_cast<std::size_t>(0.4 * bytes));
        }));
    }
}

}  // namespace
}  // namespace stratum::trace
