#include "compare/another_model.h"

#include "shapes.h"

#include <gtest/gtest.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <ctime>
#include <random>
#include <string>
#include <utility>

namespace stratum::compare {
namespace {

// An L with a slanted top: no turn makes it its mirror image.
TriangleMesh slanted() {
    TriangleMesh mesh = test::angleModel();
    for (glm::dvec3& p : mesh.points)
        if (p.z > 0) p.z += 0.2 * p.x;
    return mesh;
}

TriangleMesh scaled(TriangleMesh mesh, const glm::dvec3& by) {
    for (glm::dvec3& p : mesh.points) p *= by;
    if (by.x * by.y * by.z < 0)
        for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    return mesh;
}

// The level set of a model, as a print of it has, moved on the bed.
openvdb::FloatGrid::Ptr printOf(const TriangleMesh& mesh) {
    openvdb::initialize();
    constexpr double kVoxel = 0.25;
    const ClosedModel model(mesh, "print");
    auto grid = openvdb::createLevelSet<openvdb::FloatGrid>(kVoxel, 3);
    auto values = grid->getAccessor();
    for (int i = -8; i < 100; ++i)
        for (int j = -8; j < 60; ++j)
            for (int k = -8; k < 60; ++k) {
                const double distance = model.distance(glm::dvec3(i, j, k) * kVoxel).distance;
                if (std::abs(distance) < 3 * kVoxel) values.setValue({i, j, k}, static_cast<float>(distance));
            }
    openvdb::tools::signedFloodFill(grid->tree());
    return grid;
}

std::string doubtOf(const TriangleMesh& mesh, const CompareOptions& options = {}) {
    static const openvdb::FloatGrid::Ptr print = printOf(slanted());
    std::string text;
    for (const std::string& doubt : compareToModel(*print, ClosedModel(mesh, "model"), options).doubts)
        text += doubt + "; ";
    return text;
}

CompareOptions few() {
    CompareOptions options;
    options.samples = 5000;
    return options;
}

TEST(AnotherModel, ThePrintsOwnIsNotDoubted) {
    const Rigid moved{turnBy({0, 0, 0.7}), {50, -3, 2}};
    EXPECT_EQ(doubtOf(test::moved(slanted(), moved), few()), "");
}

TEST(AnotherModel, UnitsAreNamed) {
    for (const auto& [mm, name] : {std::pair{25.4, "inches"}, std::pair{1000.0, "metres"},
                                   std::pair{10.0, "centimetres"}, std::pair{0.001, "micrometres"}}) {
        const std::string doubt = doubtOf(scaled(slanted(), glm::dvec3(1 / mm)), few());
        EXPECT_NE(doubt.find(std::string("it fits if its numbers are ") + name), std::string::npos) << doubt;
    }
}

TEST(AnotherModel, SizesAreNamed) {
    const std::string large = doubtOf(scaled(slanted(), glm::dvec3(1.1)), few());
    EXPECT_NE(large.find("it fits at 90.9 % of its size: it is 10.0 % too large"), std::string::npos) << large;
    const std::string small = doubtOf(scaled(slanted(), glm::dvec3(0.8)), few());
    EXPECT_NE(small.find("it fits at 125.0 % of its size: it is 20.0 % too small"), std::string::npos) << small;
}

TEST(AnotherModel, TheMirrorImageIsNamed) {
    const std::string doubt = doubtOf(scaled(slanted(), {-1, 1, 1}), few());
    EXPECT_NE(doubt.find("its mirror image fits"), std::string::npos) << doubt;
}

TEST(AnotherModel, OneThatNothingMakesFitIsSaidToBe) {
    const std::string doubt = doubtOf(test::ellipsoidModel({10, 9, 4}, 20), few());
    EXPECT_NE(doubt.find("the model of another print"), std::string::npos) << doubt;
}

// A size that comes nearer, but not near, is no hint.
TEST(AnotherModel, WhatIsMerelyNearerIsAnother) {
    const std::string doubt = doubtOf(scaled(test::angleModel(), glm::dvec3(1 / 25.4)), few());
    EXPECT_NE(doubt.find("the model of another print"), std::string::npos) << doubt;
    EXPECT_EQ(doubt.find("inches"), std::string::npos) << doubt;
}

TEST(AnotherModel, BodiesInOnePlaceAreSaid) {
    TriangleMesh mesh = slanted();
    const std::vector<Triangle> once = mesh.triangles;
    mesh.triangles.insert(mesh.triangles.end(), once.begin(), once.end());
    const std::string doubt = doubtOf(mesh, few());
    EXPECT_NE(doubt.find("20 of its 40 triangles repeat others"), std::string::npos) << doubt;
}

TEST(AnotherModel, AVolumeOfAnotherOrderIsSaid) {
    const std::string doubt = doubtOf(scaled(slanted(), glm::dvec3(3)), few());
    EXPECT_NE(doubt.find("mm3, and the print's surface"), std::string::npos) << doubt;
}

// The way from the print to a far model is not sampled to its end.
TEST(AnotherModel, APointFarAwayTakesNoMinutes) {
    TriangleMesh mesh = slanted();
    mesh.points[7].z = 1000;
    const std::clock_t start = std::clock();
    EXPECT_NE(doubtOf(mesh), "");
    EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 20);
}

// As of a file whose list of points lost some: each search sees nearly all triangles.
TEST(AnotherModel, TrianglesAcrossEachOtherTakeSeconds) {
    TriangleMesh mesh = test::ellipsoidModel({10, 9, 4}, 70);
    std::mt19937 random(5);
    std::shuffle(mesh.points.begin(), mesh.points.begin() + static_cast<std::ptrdiff_t>(mesh.points.size() / 3),
                 random);
    const std::clock_t start = std::clock();
    EXPECT_NE(doubtOf(mesh), "");
#ifndef STRATUM_SANITIZED
    EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 15);
#else
    (void)start;
#endif
}

// Queries from afar see all triangles of a small model at about one distance.
TEST(AnotherModel, AFineModelInInchesTakesSeconds) {
    const TriangleMesh fine = scaled(test::ellipsoidModel({10, 9, 4}, 200), glm::dvec3(1 / 25.4));
    const std::clock_t start = std::clock();
    EXPECT_NE(doubtOf(fine), "");
#ifndef STRATUM_SANITIZED  // which takes four times as long
    EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 15);
#else
    (void)start;
#endif
}

}  // namespace
}  // namespace stratum::compare
