#include "compare/model_file.h"

#include "scratch_folder.h"
#include "shapes.h"

#include "base/error.h"
#include "compare/closed_model.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <string>

namespace stratum::compare {
namespace {

namespace fs = std::filesystem;

void writeText(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

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
    try {
        readModel(path);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
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
