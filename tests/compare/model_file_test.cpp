#include "compare/model_file.h"

#include "refusal.h"
#include "scratch_folder.h"
#include "shapes.h"

#include "base/error.h"
#include "compare/closed_model.h"

#include <gtest/gtest.h>
#include <zip.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

namespace stratum::compare {
namespace {

namespace fs = std::filesystem;

using test::writeText;

std::string asObj(const TriangleMesh& mesh) {
    std::string text;
    for (const glm::dvec3& p : mesh.points)
        text += "v " + std::to_string(p.x) + ' ' + std::to_string(p.y) + ' ' + std::to_string(p.z) + '\n';
    for (const Triangle& t : mesh.triangles)
        text +=
            "f " + std::to_string(t[0] + 1) + ' ' + std::to_string(t[1] + 1) + ' ' + std::to_string(t[2] + 1) + '\n';
    return text;
}

std::string asBinaryStl(const TriangleMesh& mesh) {
    std::string bytes(80, ' ');
    const auto raw = [&bytes](const auto& value) {
        char copy[sizeof(value)];
        std::memcpy(copy, &value, sizeof(value));
        bytes.append(copy, sizeof(value));
    };
    raw(static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const Triangle& t : mesh.triangles) {
        for (int n = 0; n < 3; ++n) raw(0.0F);
        for (std::size_t n = 0; n < 3; ++n)
            for (int axis = 0; axis < 3; ++axis) raw(static_cast<float>(mesh.corner(t, n)[axis]));
        raw(std::uint16_t{0});
    }
    return bytes;
}

std::string refusalOf(const fs::path& path) {
    return test::messageOf<InputError>([&] { readModel(path); });
}

TEST(ModelFile, ReadsObjAndStl) {
    const test::ScratchFolder folder;
    const TriangleMesh box = test::boxModel({1, 2, 3}, {4, 6, 8});
    writeText(folder / "box.obj", asObj(box));
    writeText(folder / "box.STL", asBinaryStl(box));
    for (const char* name : {"box.obj", "box.STL"}) {
        TriangleMesh mesh = readModel(folder / name);
        EXPECT_EQ(mesh.points.size(), 8U) << name;
        EXPECT_EQ(mesh.triangles.size(), 12U) << name;
        EXPECT_NEAR(ClosedModel(std::move(mesh), name).volume(), 60, 1e-5) << name;
    }
}

// A package with a model whose numbers are in this unit; empty: not stated. `item`: more of what is built.
void write3mf(const fs::path& path, const TriangleMesh& mesh, const std::string& unit, const std::string& item = "") {
    std::string model = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- it was a <model unit=\"foot\"> -->\n<model ";
    if (!unit.empty()) model += "unit=\"" + unit + "\" ";
    model +=
        "xml:lang=\"en-US\" xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><resources>"
        "<object id=\"1\" type=\"model\"><mesh><vertices>";
    for (const glm::dvec3& p : mesh.points)
        model += "<vertex x=\"" + std::to_string(p.x) + "\" y=\"" + std::to_string(p.y) + "\" z=\"" +
                 std::to_string(p.z) + "\"/>";
    model += "</vertices><triangles>";
    for (const Triangle& t : mesh.triangles)
        model += "<triangle v1=\"" + std::to_string(t[0]) + "\" v2=\"" + std::to_string(t[1]) + "\" v3=\"" +
                 std::to_string(t[2]) + "\"/>";
    model += "</triangles></mesh></object></resources><build><item objectid=\"1\" " + item + "/></build></model>";
    const std::string relations =
        "<?xml version=\"1.0\"?><Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">"
        "<Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" "
        "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";
    zip_t* archive = zip_open(path.c_str(), ZIP_CREATE | ZIP_TRUNCATE, nullptr);
    ASSERT_NE(archive, nullptr);
    const auto add = [archive](const char* name, const std::string& text) {
        zip_file_add(archive, name, zip_source_buffer(archive, text.data(), text.size(), 0), 0);
    };
    add("_rels/.rels", relations);
    add("3D/3dmodel.model", model);
    ASSERT_EQ(zip_close(archive), 0);
}

TEST(ModelFile, TheUnitOfA3mfIsThatOfItsNumbers) {
    const test::ScratchFolder folder;
    const TriangleMesh box = test::boxModel({0, 0, 0}, {1, 2, 3});
    for (const auto& [unit, mm] :
         {std::pair{"", 1.0}, std::pair{"millimeter", 1.0}, std::pair{"inch", 25.4}, std::pair{"meter", 1000.0},
          std::pair{"micron", 0.001}, std::pair{"foot", 304.8}, std::pair{"centimeter", 10.0}}) {
        write3mf(folder / "box.3mf", box, unit);
        const ClosedModel model(readModel(folder / "box.3mf"), unit);
        EXPECT_NEAR(model.volume() / (6 * mm * mm * mm), 1, 1e-6) << unit;
    }
    write3mf(folder / "box.3mf", box, "cubit");
    EXPECT_NE(refusalOf(folder / "box.3mf").find("cubit"), std::string::npos);
}

// The core specification of 3MF has the transform in rows, the offset last.
TEST(ModelFile, ItemsOfA3mfLieWhereTheirTransformsSay) {
    const test::ScratchFolder folder;
    const auto built = [&](const std::string& transform) {
        write3mf(folder / "box.3mf", test::boxModel({0, 0, 0}, {1, 2, 3}), "", "transform=\"" + transform + "\"");
        return readModel(folder / "box.3mf");
    };
    EXPECT_NEAR(ClosedModel(built("-1 0 0 0 1 0 0 0 1 10 0 0"), "mirrored").volume(), 6, 1e-6);
    EXPECT_NEAR(ClosedModel(built("0 2 0 -2 0 0 0 0 2 10 20 30"), "turned").volume(), 48, 1e-5);
    double least = 1e9;
    for (const glm::dvec3& p : built("-1 0 0 0 1 0 0 0 1 10 0 0").points) least = std::min(least, p.x);
    EXPECT_NEAR(least, 9, 1e-6);
}

TEST(ModelFile, WhatIsNoModelIsRefused) {
    const test::ScratchFolder folder;
    EXPECT_NE(refusalOf(folder / "none.stl").find("no such file"), std::string::npos);
    EXPECT_NE(refusalOf(folder / "part.gcode").find("expected .stl, .3mf or .obj"), std::string::npos);
    writeText(folder / "empty.stl", "");
    writeText(folder / "text.3mf", "this is no zip file");
    writeText(folder / "nothing.obj", "v 0 0 0\nv 1 0 0\n");
    writeText(folder / "flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 2\n");
    writeText(folder / "nan.obj", "v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n");
    writeText(folder / "cut.stl", asBinaryStl(test::boxModel({0, 0, 0}, {1, 1, 1})).substr(0, 300));
    for (const char* name : {"empty.stl", "text.3mf", "nothing.obj", "flat.obj", "nan.obj", "cut.stl"})
        EXPECT_NE(refusalOf(folder / name), "") << name;
}

}  // namespace
}  // namespace stratum::compare
