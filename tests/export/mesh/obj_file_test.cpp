#include "export/mesh/mesh_formats.h"

#include "base/error.h"
#include "export/mesh/two_materials.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>

#include <string>

namespace stratum::exporter {
namespace {

TEST(ObjFile, AGroupOfFacesAMaterial) {
    const test::ScratchFolder folder;
    writeObj(test::twoMaterials(), folder.path() / "part.obj");
    const std::string obj = test::bytesOf(folder.path() / "part.obj");
    EXPECT_NE(obj.find("mtllib part.mtl\nv 0 0 0\n"), std::string::npos) << obj;
    EXPECT_NE(obj.find("usemtl tool_0\nf 3 4 5\nf 4 1 5\nusemtl tool_1\nf 4 3 2 1\nf 1 2 5\nf 2 3 5\n"),
              std::string::npos)
        << obj;
    const std::string mtl = test::bytesOf(folder.path() / "part.mtl");
    EXPECT_NE(mtl.find("newmtl tool_0\n# sRGB #ff8000\nKd 1.000000 0.215861 0.000000\n"), std::string::npos) << mtl;
    EXPECT_NE(mtl.find("newmtl tool_1\n# sRGB #0000ff\nKd 0.000000 0.000000 1.000000\n"), std::string::npos) << mtl;
}

TEST(ObjFile, BothFilesOrNone) {
    const test::ScratchFolder folder;
    // The .mtl can't get its name: a folder has it.
    std::filesystem::create_directories(folder.path() / "part.mtl" / "full");
    EXPECT_THROW(writeObj(test::twoMaterials(), folder.path() / "part.obj"), OutputError);
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "part.obj"));
    EXPECT_THROW(writeObj(test::twoMaterials(), "-.obj"), UsageError);
}

}  // namespace
}  // namespace stratum::exporter
