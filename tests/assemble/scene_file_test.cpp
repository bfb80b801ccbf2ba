#include "assemble/scene_file.h"

#include "base/error.h"
#include "refusal.h"
#include "scratch_folder.h"
#include "shade/map_files.h"

namespace stratum {
namespace {

using assemble::readSceneFile;

TEST(SceneFile, ReadsEveryKey) {
    const test::ScratchFolder scratch;
    test::writeText(scratch / "map.hdr", "x");
    test::writeText(scratch / "s.json", R"({
      // comments explain
      "print": "part.vdb", "grid": "surface", "output": "out.exr",
      "size": [320, 240], "crop": [1, 2, 3, 4], "spp": 8, "seed": 7, "noise": 0.1, "time": 30, "checkpoint": "part.state",
      "denoise": true, "exposure": -1.5, "file_up": "y",
      "aov": "normal,depth", "material": "lambert:1,1,1", "bed": false, "bed_surface": "pei",
      "camera": {"view": "top", "eye": [1, 2, 3], "look_at": [0, 0, 0], "up": [0, 0, 1], "fov": 40},
      "environment": {"map": "map.hdr", "rotation": 90, "exposure": 2},
      "lights": ["ambient:1,1,1", "point:0,0,1,1,1,1"],
      "integrator": {"name": "phong", "bounces": 5, "ao_distance": 3, "phong": [1, 2, 3, 4, 0.5]}
    })");
    const auto file = readSceneFile(scratch / "s.json");
    EXPECT_EQ(file.print, (scratch / "part.vdb").string());
    EXPECT_EQ(file.grid, "surface");
    EXPECT_EQ(file.output, "out.exr");
    EXPECT_EQ(file.render.width, 320);
    EXPECT_EQ(file.render.crop, (shade::PixelBox{1, 2, 3, 4}));
    EXPECT_EQ(file.render.spp, 8);
    EXPECT_TRUE(file.spp_given);
    EXPECT_EQ(file.render.seed, 7u);
    EXPECT_EQ(file.render.noise, 0.1);
    EXPECT_EQ(file.render.seconds, 30.0);
    EXPECT_EQ(file.render.checkpoint, "part.state");
    EXPECT_TRUE(file.denoise);
    EXPECT_EQ(file.file_up, "y");
    EXPECT_EQ(file.exposure, -1.5);
    EXPECT_EQ(file.render.aovs.size(), 2u);
    EXPECT_EQ(file.scene.brdf, "lambert:1,1,1");
    EXPECT_FALSE(file.scene.bed);
    EXPECT_EQ(file.scene.bed_surface, shade::BedSurface::pei);
    EXPECT_EQ(file.scene.camera.view, shade::View::top);
    ASSERT_EQ(file.notes.size(), 1u);
    EXPECT_NE(file.notes[0].find("camera.view is not used: expected no eye beside it"), std::string::npos);
    EXPECT_EQ(file.scene.camera.eye, glm::dvec3(1, 2, 3));
    EXPECT_EQ(file.scene.camera.fov, 40.0);
    EXPECT_EQ(file.scene.env, (scratch / "map.hdr").string());
    EXPECT_EQ(file.scene.env_rotation, 90.0);
    EXPECT_EQ(file.scene.env_exposure, 2.0);
    EXPECT_EQ(file.scene.lights.size(), 2u);
    EXPECT_EQ(file.render.integrator.name, "phong");
    EXPECT_EQ(file.render.integrator.bounces, 5);
    EXPECT_EQ(file.render.integrator.phong.shininess, 4.0f);
}

TEST(SceneFile, LeavesDefaultsAlone) {
    const test::ScratchFolder scratch;
    test::writeText(scratch / "s.json", R"({"print": "p.vdb"})");
    const auto file = readSceneFile(scratch / "s.json");
    EXPECT_EQ(file.scene.env, "studio");
    EXPECT_EQ(file.render.spp, 16);
    EXPECT_FALSE(file.spp_given);
    EXPECT_FALSE(file.denoise);
    EXPECT_EQ(file.file_up, "");
}

TEST(SceneFile, SaysWhatIsWrong) {
    const test::ScratchFolder scratch;
    const auto refused = [&](const char* text, const char* word) {
        test::writeText(scratch / "s.json", text);
        EXPECT_TRUE(test::refuses<InputError>(word, [&] { readSceneFile(scratch / "s.json"); })) << text;
    };
    refused(R"({"print": })", "line 1");
    refused(R"({})", "print");
    refused(R"({"print": "p.vdb", "enviroment": {}})", "did you mean 'environment'");
    refused(R"({"print": "p.vdb", "camera": {"fow": 3}})", "camera.fow: unknown key; did you mean 'fov'");
    refused(R"({"print": "p.vdb", "camera": 3})", "camera: expected an object");
    refused(R"({"print": "p.vdb", "size": [1]})", "size: expected the width");
    refused(R"({"print": "p.vdb", "spp": -3})", "spp: expected a whole number");
    refused(R"({"print": "p.vdb", "spp": 1e99})", "spp");
    refused(R"({"print": "p.vdb", "bed": 1})", "bed: expected true or false");
    refused(R"({"print": "p.vdb", "spp": 1, "print": "q.vdb"})", "print is there twice");
    refused(R"({"objects": [{"vdb": "p.vdb"}, {"vdb": "q.vdb", "transform": {"scale": 1, "scale": 2}}]})",
            "objects[1].transform.scale is there twice");
    refused(R"({"lights": [[1, {}], {"a": [[{}, {"b": 1}], {"c": 1, "c": 2}]}]})", "lights[1].a[1].c is there twice");
    refused(R"({"print": "p.vdb", "camera": {"f_number": 0}})", "camera.f_number: expected a number above 0");
    refused(R"({"print": "p.vdb", "camera": {"eye": [1, 2, 3], "photograph": {}}})",
            "camera.photograph: expected no eye");
    refused(R"({"print": "p.vdb", "camera": {"fov": 30, "photograph": {}}})", "camera.photograph: expected no fov");
    refused(R"({"print": "p.vdb", "camera": {"view": "top", "photograph": {}}})",
            "camera.photograph: expected no view");
    refused(R"({"print": "p.vdb", "color": "red", "color_by": "layer"})", "color: expected no color_by");
    refused(R"({"print": "p.vdb", "lights": [1]})", "lights");
    refused(R"({"print": "p.vdb", "denoise": 1})", "denoise: expected true or false");
    refused(R"({"print": "p.vdb", "file_up": "x"})", "file_up: expected one of z, y");
    refused(R"({"file_up": "y", "objects": [{"vdb": "p.vdb"}]})", "file_up");
    refused(R"([1])", "the file: expected an object");
}

TEST(SceneFile, IsToldByItsBrace) {
    EXPECT_TRUE(assemble::isSceneFile("\n {"));
    EXPECT_TRUE(assemble::isSceneFile("\xef\xbb\xbf// a lamp\n/* of glass */ {"));
    EXPECT_FALSE(assemble::isSceneFile("// no end"));
    EXPECT_FALSE(assemble::isSceneFile("/* no end"));
    EXPECT_FALSE(assemble::isSceneFile(" BDV"));
    EXPECT_FALSE(assemble::isSceneFile(""));
}

}  // namespace
}  // namespace stratum
