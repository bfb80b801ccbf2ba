#include "export/mesh_file.h"

#include "base/error.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>

#include <cstring>
#include <sstream>
#include <string>
#include <vector>

namespace stratum::exporter {
namespace {

using test::bytesOf;

// A pyramid: one quad below, four triangles.
SurfaceMesh pyramid() {
    SurfaceMesh mesh;
    mesh.points = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 3}};
    constexpr std::uint32_t none = SurfaceMesh::kNone;
    mesh.faces = {{3, 2, 1, 0}, {0, 1, 4, none}, {1, 2, 4, none}, {2, 3, 4, none}, {3, 0, 4, none}};
    return mesh;
}

template <typename T>
T at(const std::string& bytes, std::size_t offset) {
    T value;
    std::memcpy(&value, bytes.data() + offset, sizeof(T));
    return value;
}

}  // namespace

TEST(MeshFile, KnowsItsExtensions) {
    EXPECT_TRUE(isMeshPath("part.stl") && isMeshPath("part.PLY") && isMeshPath("a.b/part.obj"));
    EXPECT_TRUE(isMeshPath("part.3mf") && isMeshPath("part.GLB") && isMeshPath("part.usda"));
    EXPECT_EQ(meshColors("part.stl"), MeshColors::none);
    EXPECT_EQ(meshColors("part.ply"), MeshColors::points);
    EXPECT_EQ(meshColors("part.obj"), MeshColors::optional_materials);
    EXPECT_EQ(meshColors("part.3MF"), MeshColors::materials);
    EXPECT_EQ(meshCompanion("a/part.obj"), std::filesystem::path("a/part.mtl"));
    EXPECT_EQ(meshCompanion("-.obj"), std::nullopt);
    EXPECT_EQ(meshCompanion("part.glb"), std::nullopt);
    EXPECT_FALSE(isMeshPath("part.vdb") || isMeshPath("stl") || isMeshPath("part.stl.vdb"));
}

TEST(MeshFile, StlHoldsTrianglesWithOutwardNormals) {
    const test::ScratchFolder folder;
    const auto path = folder.path() / "pyramid.stl";
    writeMesh(pyramid(), path);
    const std::string bytes = bytesOf(path);
    ASSERT_EQ(bytes.size(), 84U + 6U * 50U);
    EXPECT_NE(bytes.substr(0, 5), "solid");  // which would announce text
    EXPECT_EQ(at<std::uint32_t>(bytes, 80), 6U);
    double six = 0;
    for (std::size_t n = 0; n < 6; ++n) {
        openvdb::Vec3d v[4];
        for (std::size_t k = 0; k < 12; ++k) v[k / 3][static_cast<int>(k % 3)] = at<float>(bytes, 84 + n * 50 + k * 4);
        EXPECT_NEAR(v[0].length(), 1.0, 1e-6);
        EXPECT_GT(v[0].dot(v[1] - openvdb::Vec3d(1, 1, 1)), 0);
        EXPECT_NEAR(v[0].dot(v[2] - v[1]), 0, 1e-6);
        six += v[1].dot(v[2].cross(v[3]));
    }
    EXPECT_NEAR(six / 6, 4.0, 1e-6);
}

TEST(MeshFile, PlyHoldsSharedPoints) {
    const test::ScratchFolder folder;
    const auto path = folder.path() / "pyramid.ply";
    writeMesh(pyramid(), path);
    const std::string bytes = bytesOf(path);
    EXPECT_NE(bytes.find("element vertex 5\n"), std::string::npos);
    EXPECT_NE(bytes.find("element face 5\n"), std::string::npos);
    const std::string end = "end_header\n";
    const std::size_t data = bytes.find(end) + end.size();
    ASSERT_EQ(bytes.size(), data + 5 * 12 + (1 + 16) + 4 * (1 + 12));
    EXPECT_EQ(at<float>(bytes, data + 4 * 12 + 8), 3.0F);
    EXPECT_EQ(at<std::uint8_t>(bytes, data + 60), 4);
    EXPECT_EQ(at<std::uint32_t>(bytes, data + 61), 3U);
    EXPECT_EQ(at<std::uint8_t>(bytes, data + 77), 3);
}

TEST(MeshFile, ObjCountsFromOne) {
    const test::ScratchFolder folder;
    const auto path = folder.path() / "pyramid.obj";
    writeMesh(pyramid(), path);
    std::istringstream text(bytesOf(path));
    std::vector<std::string> vertices, faces;
    for (std::string line; std::getline(text, line);) {
        if (line[0] == 'v') vertices.push_back(line);
        if (line[0] == 'f') faces.push_back(line);
    }
    EXPECT_EQ(vertices, (std::vector<std::string>{"v 0 0 0", "v 2 0 0", "v 2 2 0", "v 0 2 0", "v 1 1 3"}));
    EXPECT_EQ(faces, (std::vector<std::string>{"f 4 3 2 1", "f 1 2 5", "f 2 3 5", "f 3 4 5", "f 4 1 5"}));
}

TEST(MeshFile, AFailedWriteLeavesTheOldFile) { EXPECT_THROW(writeMesh(pyramid(), "/nowhere/at/all.stl"), OutputError); }

}  // namespace stratum::exporter
