#include "export/mesh/face_groups.h"

#include "export/mesh/two_materials.h"

#include <gtest/gtest.h>

#include <vector>

namespace stratum::exporter {
namespace {

TEST(FaceGroups, AFaceIsOfWhatMostOfItsPointsAre) {
    const SurfaceMesh mesh = test::twoMaterials();
    std::vector<std::uint32_t> materials;
    for (const SurfaceMesh::Face& face : mesh.faces) materials.push_back(mesh.materialOf(face));
    EXPECT_EQ(materials, (std::vector<std::uint32_t>{1, 1, 1, 0, 0}));
}

TEST(FaceGroups, PartTheFaces) {
    const SurfaceMesh mesh = test::twoMaterials();
    const FaceGroups groups(mesh);
    ASSERT_EQ(groups.count(), 2U);
    EXPECT_EQ(groups.faces(0), 2U);
    EXPECT_EQ(groups.faces(1), 3U);
    EXPECT_EQ(groups.triangles(0), 2U);
    EXPECT_EQ(groups.triangles(1), 4U);
    std::vector<std::uint32_t> firsts;
    for (std::size_t group = 0; group < 2; ++group)
        groups.forEachFace(mesh, group, [&](const SurfaceMesh::Face& face) { firsts.push_back(face[0]); });
    EXPECT_EQ(firsts, (std::vector<std::uint32_t>{2, 3, 3, 0, 1}));  // each group in the mesh's order
}

TEST(FaceGroups, WithoutMaterialsAllAreOne) {
    SurfaceMesh mesh = test::twoMaterials();
    mesh.materials.clear();
    mesh.material_of_point.clear();
    const FaceGroups groups(mesh);
    EXPECT_EQ(groups.count(), 1U);
    EXPECT_EQ(groups.triangles(0), 6U);
    EXPECT_EQ(FaceGroups(SurfaceMesh()).faces(0), 0U);
}

}  // namespace
}  // namespace stratum::exporter
