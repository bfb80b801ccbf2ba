#include "study/polygons/triangle_mesh.h"

#include "base/error.h"
#include "corpus.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <fstream>
#include <map>
#include <numbers>
#include <utility>

namespace stratum::study {
namespace {

// Every edge is shared by two triangles that run along it in opposite ways.
void expectClosed(const TriangleMesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const glm::uvec3& t : mesh.triangles)
        for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    for (const auto& [edge, count] : edges) {
        EXPECT_EQ(count, 1);
        EXPECT_EQ((edges[{edge.second, edge.first}]), 1);
    }
}

// By the divergence theorem; positive if triangles face outwards.
double volume(const TriangleMesh& mesh) {
    double sum = 0;
    for (const glm::uvec3& t : mesh.triangles)
        sum += glm::dot(mesh.corners[t.x], glm::cross(mesh.corners[t.y], mesh.corners[t.z])) / 6;
    return sum;
}

TEST(TriangleMesh, OfABoxIsExact) {
    const TriangleMesh box = boxMesh({1, -2, 3}, {0.5, 1, 2});
    expectClosed(box);
    EXPECT_EQ(box.triangles.size(), 12U);
    EXPECT_NEAR(volume(box), 8, 1e-12);
}

TEST(TriangleMesh, OfASphereFillsItFromWithin) {
    for (const int rings : {3, 7, 14, 100}) {
        const TriangleMesh sphere = sphereMesh({1, 2, 3}, 2, rings);
        expectClosed(sphere);
        EXPECT_EQ(sphere.triangles.size(), static_cast<std::size_t>(2 * rings * (rings - 1)));
        for (const glm::dvec3& p : sphere.corners) EXPECT_NEAR(glm::distance(p, {1, 2, 3}), 2, 1e-12);
    }
    EXPECT_NEAR(volume(sphereMesh({1, 2, 3}, 2, 100)), 32 * std::numbers::pi / 3, 32 * std::numbers::pi / 3 * 3e-3);
}

TEST(TriangleMesh, OfACylinderIsAPrism) {
    for (int axis = 0; axis < 3; ++axis) {
        const TriangleMesh prism = cylinderMesh({1, 2, 3}, 1.5, 0.5, axis, 10);
        expectClosed(prism);
        EXPECT_EQ(prism.triangles.size(), 40U);
        EXPECT_NEAR(volume(prism), 5 * 1.5 * 1.5 * std::sin(2 * std::numbers::pi / 10), 1e-12);
        for (const glm::dvec3& p : prism.corners) EXPECT_NEAR(std::abs(p[axis] - (axis + 1)), 0.5, 1e-12);
    }
}

TEST(TriangleMesh, OfASceneHasItsObjects) {
    const TriangleMesh scene = sceneMesh(test::dataDir() / "scenes" / "roukema_7.json", 7, 10);
    EXPECT_EQ(scene.triangles.size(), 84U + 40U + 12U);
    EXPECT_EQ(scene.objects.size(), scene.triangles.size());
    EXPECT_EQ(scene.objects.front(), 0U);
    EXPECT_EQ(scene.objects[100], 1U);
    EXPECT_EQ(scene.objects.back(), 2U);
    expectClosed(scene);
}

TEST(TriangleMesh, SaysWhatHasNone) {
    const test::ScratchFolder folder;
    const auto path = folder.path() / "torus.json";
    std::ofstream(path) << R"({"objects": [{"sdf": {"torus": {"center": [0, 0, 0], "radius": 2, "tube": 1}}}]})";
    EXPECT_THROW(sceneMesh(path, 7, 10), InputError);
    std::ofstream(path) << R"({"objects": [{"sdf": {"sphere": {"center": [0, 0, 0]}}}]})";
    EXPECT_THROW(sceneMesh(path, 7, 10), InputError);
}

}  // namespace
}  // namespace stratum::study
