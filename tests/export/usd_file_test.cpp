#include "export/usd_file.h"

#include "base/error.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>

#include <string>

namespace stratum::exporter {
namespace {

template <typename Grid>
typename Grid::Ptr named(const char* name, const openvdb::math::Transform::Ptr& transform) {
    auto grid = Grid::create();
    grid->setName(name);
    grid->setTransform(transform);
    grid->tree().setValueOn(openvdb::Coord(0, 0, 0));
    grid->tree().setValueOn(openvdb::Coord(10, 20, 30));
    return grid;
}

openvdb::GridPtrVec print() {
    const auto transform = openvdb::math::Transform::createLinearTransform(0.5);
    transform->postTranslate(openvdb::Vec3d(1, 2, 3));
    const auto surface = named<openvdb::FloatGrid>("surface", transform);
    surface->setGridClass(openvdb::GRID_LEVEL_SET);
    return {surface, named<openvdb::Int32Grid>("layer", transform), named<openvdb::Vec3SGrid>("color", transform)};
}

/// The part between the braces that follow `def ... "name"`.
std::string primOf(const std::string& text, const std::string& name) {
    const std::size_t begin = text.find("def OpenVDBAsset \"" + name + "\"");
    return begin == std::string::npos ? "" : text.substr(begin, text.find("    }\n", begin) - begin);
}

std::size_t countOf(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
    return count;
}

class UsdFile : public testing::Test {
protected:
    static void SetUpTestSuite() { openvdb::initialize(); }
    test::ScratchFolder folder_;
};

TEST_F(UsdFile, NamesEveryGridOfTheFileBesideIt) {
    writeUsda(print(), folder_ / "part.vdb", folder_ / "part.usda");
    const std::string text = test::bytesOf(folder_ / "part.usda");
    EXPECT_TRUE(text.starts_with("#usda 1.0\n"));
    for (const std::string name : {"surface", "layer", "color"}) {
        EXPECT_NE(text.find("rel field:" + name + " = </print/" + name + ">"), std::string::npos) << name;
        const std::string prim = primOf(text, name);
        EXPECT_NE(prim.find("asset filePath = @./part.vdb@"), std::string::npos) << name;
        EXPECT_NE(prim.find("token fieldName = \"" + name + "\""), std::string::npos) << name;
    }
    EXPECT_EQ(countOf(text, "{"), countOf(text, "}"));
    EXPECT_EQ(countOf(text, "def OpenVDBAsset"), 3U);
}

TEST_F(UsdFile, SaysWhatTheGridsHold) {
    writeUsda(print(), folder_ / "part.vdb", folder_ / "part.usda");
    const std::string text = test::bytesOf(folder_ / "part.usda");
    EXPECT_NE(primOf(text, "surface").find("fieldDataType = \"float\""), std::string::npos);
    EXPECT_NE(primOf(text, "surface").find("fieldClass = \"levelSet\""), std::string::npos);
    EXPECT_NE(primOf(text, "layer").find("fieldDataType = \"int\""), std::string::npos);
    EXPECT_EQ(primOf(text, "layer").find("fieldClass"), std::string::npos);
    EXPECT_NE(primOf(text, "color").find("fieldDataType = \"float3\""), std::string::npos);
    EXPECT_NE(primOf(text, "color").find("vectorDataRoleHint = \"Color\""), std::string::npos);
}

// Voxel (0, 0, 0) is at (1, 2, 3), voxel (10, 20, 30) half as many units on.
TEST_F(UsdFile, ExtentUnitAndAxis) {
    writeUsda(print(), folder_ / "a.vdb", folder_ / "a.usda");
    const std::string plain = test::bytesOf(folder_ / "a.usda");
    EXPECT_NE(plain.find("extent = [(1, 2, 3), (6, 12, 18)]"), std::string::npos) << plain;
    EXPECT_NE(plain.find("metersPerUnit = 0.001"), std::string::npos);
    EXPECT_NE(plain.find("upAxis = \"Z\""), std::string::npos);
    writeUsda(print(), folder_ / "a.vdb", folder_ / "a.usda", {.meters_per_unit = 1, .up_y = true});
    const std::string houdini = test::bytesOf(folder_ / "a.usda");
    EXPECT_NE(houdini.find("metersPerUnit = 1\n"), std::string::npos);
    EXPECT_NE(houdini.find("upAxis = \"Y\""), std::string::npos);
}

TEST_F(UsdFile, AMaterialAFilament) {
    writeUsda(print(), folder_ / "a.vdb", folder_ / "a.usda", {.materials = {{"tool_0", {255, 0, 0}}}});
    const std::string one = test::bytesOf(folder_ / "a.usda");
    EXPECT_NE(one.find("rel material:binding = </print/materials/tool_0>"), std::string::npos) << one;
    EXPECT_NE(one.find("prepend apiSchemas = [\"MaterialBindingAPI\"]"), std::string::npos) << one;
    EXPECT_NE(one.find("color3f inputs:diffuseColor = (1.000000, 0.000000, 0.000000)"), std::string::npos) << one;
    writeUsda(print(), folder_ / "a.vdb", folder_ / "a.usda",
              {.materials = {{"tool_0", {255, 0, 0}}, {"tool_1", {0, 0, 255}}}});
    const std::string two = test::bytesOf(folder_ / "a.usda");
    EXPECT_EQ(two.find("material:binding"), std::string::npos) << two;
    EXPECT_EQ(countOf(two, "def Material"), 2U);
    EXPECT_EQ(countOf(two, "{"), countOf(two, "}"));
}

TEST_F(UsdFile, RefusesWhatUsdCannotName) {
    EXPECT_THROW(writeUsda(print(), folder_ / "a@b.vdb", folder_ / "a.usda"), OutputError);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "a.usda"));
    EXPECT_THROW(writeUsda(print(), folder_ / "a.vdb", folder_ / "none/a.usda"), OutputError);
}

}  // namespace
}  // namespace stratum::exporter
