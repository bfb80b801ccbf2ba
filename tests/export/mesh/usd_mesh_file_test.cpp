#include "export/mesh/mesh_formats.h"

#include "base/error.h"
#include "export/mesh/two_materials.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace stratum::exporter {
namespace {

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(UsdMeshFile, KeepsQuadsAndPartsThemByMaterial) {
    const test::ScratchFolder folder;
    writeUsdMesh(test::twoMaterials(), folder.path() / "part.usda", {});
    const std::string text = test::bytesOf(folder.path() / "part.usda");
    EXPECT_TRUE(text.starts_with("#usda 1.0\n"));
    EXPECT_TRUE(holds(text, "metersPerUnit = 0.001") && holds(text, "upAxis = \"Z\"")) << text;
    EXPECT_TRUE(holds(text, "float3[] extent = [(0, 0, 0), (2, 2, 3)]")) << text;
    EXPECT_TRUE(holds(text, "int[] faceVertexCounts = [4, 3, 3, 3, 3]")) << text;
    EXPECT_TRUE(holds(text, "int[] faceVertexIndices = [3, 2, 1, 0, 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4]")) << text;
    EXPECT_TRUE(holds(text, "def GeomSubset \"tool_0\"") && holds(text, "int[] indices = [3, 4]\n")) << text;
    EXPECT_TRUE(holds(text, "def GeomSubset \"tool_1\"") && holds(text, "int[] indices = [0, 1, 2]\n")) << text;
    EXPECT_TRUE(holds(text, "color3f inputs:diffuseColor = (1.000000, 0.215861, 0.000000)")) << text;
    EXPECT_EQ(std::count(text.begin(), text.end(), '{'), std::count(text.begin(), text.end(), '}'));
}

TEST(UsdMeshFile, OneMaterialIsBoundToTheMesh) {
    const test::ScratchFolder folder;
    SurfaceMesh mesh = test::twoMaterials();
    mesh.materials.pop_back();
    mesh.material_of_point.clear();
    writeUsdMesh(mesh, folder.path() / "part.usda", {10, true});
    const std::string text = test::bytesOf(folder.path() / "part.usda");
    EXPECT_TRUE(holds(text, "rel material:binding = </print/materials/tool_0>")) << text;
    EXPECT_FALSE(holds(text, "GeomSubset"));
    EXPECT_TRUE(holds(text, "metersPerUnit = 0.01\n") && holds(text, "upAxis = \"Y\"")) << text;
    mesh.materials.clear();
    writeUsdMesh(mesh, folder.path() / "bare.usda", {});
    EXPECT_FALSE(holds(test::bytesOf(folder.path() / "bare.usda"), "aterial"));
}

}  // namespace
}  // namespace stratum::exporter
