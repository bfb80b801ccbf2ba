#include "study/polygons/mesh_intersector.h"

#include "trace/sdf_intersector.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <random>

namespace stratum::study {
namespace {

trace::Ray randomRay(std::mt19937& random, double reach) {
    std::normal_distribution<double> normal;
    const glm::dvec3 from = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    const glm::dvec3 to(normal(random), normal(random), normal(random));
    return {reach * from, glm::normalize(to - reach * from)};
}

// A box is a box, whether by formula or by triangles.
TEST(MeshIntersector, MeetsABoxWhereItsFormulaDoes) {
    const auto mesh = makeMeshIntersector(boxMesh({0.1, 0.2, 0.3}, {1, 0.7, 0.4}));
    const auto formula = trace::makeSdfIntersector(trace::sdfBox({0.1, 0.2, 0.3}, {1, 0.7, 0.4}));
    const auto a = mesh->makeTracer();
    const auto b = formula->makeTracer();
    std::mt19937 random(1);
    int met = 0;
    int disagreed = 0;
    for (int n = 0; n < 20000; ++n) {
        const trace::Ray ray = randomRay(random, 5);
        trace::Hit p;
        trace::Hit q;
        const bool one = a->intersect(ray, p);
        EXPECT_EQ(one, a->occluded(ray));
        // A formula's steps may pass over an edge by a hair.
        if (one != b->intersect(ray, q)) {
            ++disagreed;
            continue;
        }
        if (!one) continue;
        ++met;
        EXPECT_NEAR(p.t, q.t, 1e-6);
        EXPECT_NEAR(glm::length(ray.origin + p.t * ray.direction - p.position), 0, 1e-12);
    }
    EXPECT_GT(met, 5000);
    EXPECT_LE(disagreed, 3);
}

TEST(MeshIntersector, HasNormalsAndObjectsOfItsTriangles) {
    TriangleMesh two = boxMesh({0, 0, 0}, glm::dvec3(1));
    two.append(sphereMesh({5, 0, 0}, 1, 14), 7);
    const auto mesh = makeMeshIntersector(two);
    const auto tracer = mesh->makeTracer();
    trace::Hit hit;
    ASSERT_TRUE(tracer->intersect({{0.2, 0.1, 9}, {0, 0, -1}}, hit));
    EXPECT_NEAR(hit.t, 8, 1e-12);
    EXPECT_NEAR(glm::distance(hit.normal, {0, 0, 1}), 0, 1e-12);
    EXPECT_EQ(hit.object, 0U);
    ASSERT_TRUE(tracer->intersect({{9, 0.1, 0.1}, {-1, 0, 0}}, hit));
    EXPECT_GT(hit.normal.x, 0.9);
    EXPECT_EQ(hit.object, 7U);
    EXPECT_FALSE(tracer->intersect({{0.2, 0.1, 9}, {0, 0, -1}, 0, 7.9}, hit));
    EXPECT_FALSE(tracer->occluded({{0.2, 0.1, 9}, {0, 0, -1}, 8.1, 9}));  // from within nothing is met
    EXPECT_FALSE(tracer->intersect({{0, 0, 0}, {0, 0, 1}}, hit));
}

}  // namespace
}  // namespace stratum::study
