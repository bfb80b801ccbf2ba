#include "export/mesh/mesh_formats.h"

#include "base/error.h"
#include "base/own_file.h"
#include "export/mesh/two_materials.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>
#include <zip.h>

#include <array>
#include <fstream>
#include <string>

namespace stratum::exporter {
namespace {

std::string entry(const std::filesystem::path& path, const char* name) {
    int failed = 0;
    zip_t* archive = zip_open(path.c_str(), ZIP_RDONLY | ZIP_CHECKCONS, &failed);
    if (archive == nullptr) return "no archive";
    std::string text;
    if (zip_file_t* file = zip_fopen(archive, name, 0)) {
        std::array<char, 4096> bytes{};
        for (zip_int64_t n = 0; (n = zip_fread(file, bytes.data(), bytes.size())) > 0;)
            text.append(bytes.data(), static_cast<std::size_t>(n));
        zip_fclose(file);
    }
    zip_discard(archive);
    return text;
}

TEST(ThreeMfFile, HoldsTheMeshAndItsMaterials) {
    const test::ScratchFolder folder;
    write3mf(test::twoMaterials(), folder.path() / "part.3mf", {});
    const std::string model = entry(folder.path() / "part.3mf", "3D/3dmodel.model");
    EXPECT_NE(model.find("<model unit=\"millimeter\""), std::string::npos) << model;
    EXPECT_NE(model.find("<basematerials id=\"1\"><base name=\"tool_0\" displaycolor=\"#ff8000\"/>"
                         "<base name=\"tool_1\" displaycolor=\"#0000ff\"/></basematerials>"),
              std::string::npos)
        << model;
    EXPECT_NE(model.find("<vertex x=\"1\" y=\"1\" z=\"3\"/>"), std::string::npos);
    // A quad is two triangles; the object's own material is the first one.
    EXPECT_NE(model.find("<triangle v1=\"3\" v2=\"2\" v3=\"1\" pid=\"1\" p1=\"1\"/>\n"
                         "<triangle v1=\"3\" v2=\"1\" v3=\"0\" pid=\"1\" p1=\"1\"/>\n"),
              std::string::npos)
        << model;
    EXPECT_NE(model.find("<triangle v1=\"3\" v2=\"0\" v3=\"4\"/>\n</triangles>"), std::string::npos) << model;
    EXPECT_NE(entry(folder.path() / "part.3mf", "_rels/.rels").find("Target=\"/3D/3dmodel.model\""), std::string::npos);
}

TEST(ThreeMfFile, SaysItsUnitAndKeepsZUp) {
    const test::ScratchFolder folder;
    SurfaceMesh mesh = test::twoMaterials();
    mesh.materials.clear();
    mesh.material_of_point.clear();
    write3mf(mesh, folder.path() / "part.3mf", {1000, true});
    const std::string model = entry(folder.path() / "part.3mf", "3D/3dmodel.model");
    EXPECT_NE(model.find("unit=\"meter\""), std::string::npos);
    EXPECT_NE(model.find("<vertex x=\"1\" y=\"-3\" z=\"1\"/>"), std::string::npos) << model;
    EXPECT_EQ(model.find("basematerials"), std::string::npos);
    EXPECT_EQ(model.find("pid="), std::string::npos);
}

TEST(ThreeMfFile, ManyPiecesGiveTheSameBytesTwice) {
    // More points and faces than are made at once.
    SurfaceMesh mesh;
    constexpr std::uint32_t kPoints = 30000;
    for (std::uint32_t n = 0; n < kPoints; ++n) {
        mesh.points.emplace_back(static_cast<float>(n) * 0.1F, static_cast<float>(n % 7), 0.3F);
        mesh.faces.push_back({n, (n + 1) % kPoints, (n + 2) % kPoints, SurfaceMesh::kNone});
    }
    const test::ScratchFolder folder;
    write3mf(mesh, folder.path() / "a.3mf", {});
    write3mf(mesh, folder.path() / "b.3mf", {});
    EXPECT_EQ(test::bytesOf(folder.path() / "a.3mf"), test::bytesOf(folder.path() / "b.3mf"));
    const std::string model = entry(folder.path() / "a.3mf", "3D/3dmodel.model");
    std::size_t count = 0;
    for (std::size_t place = model.find("<triangle "); place != std::string::npos;
         place = model.find("<triangle ", place + 1))
        ++count;
    EXPECT_EQ(count, kPoints);
    EXPECT_TRUE(model.ends_with("</build></model>\n"));
}

TEST(ThreeMfFile, SaysWhoseItIs) {
    const test::ScratchFolder folder;
    write3mf(test::twoMaterials(), folder.path() / "part.3mf", {});
    EXPECT_TRUE(isOwnFile(folder.path() / "part.3mf"));
    EXPECT_FALSE(isOwnFile(folder.path() / "none.3mf"));
    std::ofstream(folder.path() / "text.3mf") << "no archive, though it says Stratum";
    EXPECT_FALSE(isOwnFile(folder.path() / "text.3mf"));
}

TEST(ThreeMfFile, AFailedWriteLeavesNothing) {
    EXPECT_THROW(write3mf(test::twoMaterials(), "/nowhere/at/all.3mf", {}), OutputError);
}

}  // namespace
}  // namespace stratum::exporter
