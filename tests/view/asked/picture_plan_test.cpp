#include "view/asked/picture_plan.h"

#include "shade/camera/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace stratum::view {
namespace {

GivenInput given() {
    GivenInput input;
    input.path = "my part.gcode";
    input.objects.push_back({.vdb = input.path});
    input.words = {"--voxel-size=0.1"};
    return input;
}

std::string lineOf(const ViewState& state) { return shellLine(planPicture(given(), state).words); }

TEST(PicturePlan, TheLineBeginsAsGiven) {
    EXPECT_EQ(lineOf(ViewState()), "vdbtrace 'my part.gcode' --voxel-size=0.1 --size 1280x720");
}

TEST(PicturePlan, EveryChoiceIsInTheLine) {
    ViewState state;
    state.eye = {1.25, -2.5, 3};
    state.look_at = {0, 0, 0.5};
    state.fov = 35;
    state.first_layer = 4;
    state.printed = 50;
    state.by_time = true;
    state.hidden_features = {"skirt", "infill"};
    state.objects = {2};
    state.tools = {0, 1};
    state.color_by = "layer";
    state.color_range = {2, 9.5};
    state.material = "#ff8800";
    state.light = "sky:20,-30";
    state.light_rotation = -10;
    state.bed = false;
    state.exposure = -0.5;
    state.smooth = true;
    state.clip = trace::ClipPlane{{-1, 0, 0}, -90};
    state.spp = 16;
    const std::string line = lineOf(state);
    for (const char* words :
         {"--eye=1.25,-2.5,3 --look-at=0,0,0.5", "--fov 35", "--layers 4:", "--printed time:50%",
          "--features=-skirt,-infill", "--object 2", "--tool 0 --tool 1", "--color-by layer --color-range=2,9.5",
          "--brdf '#ff8800'", "--env sky:20,-30", "--env-rotation=-10", "--no-bed", "--exposure=-0.5",
          "--normals smooth", "--clip=-1,0,0,-90", "--spp 16"})
        EXPECT_NE(line.find(words), std::string::npos) << words << " in " << line;
}

TEST(PicturePlan, KeysTellWhatMustBeMadeAnew) {
    ViewState state;
    const PicturePlan first = planPicture(given(), state);
    state.named = shade::View::top;
    state.width = 100;
    const PicturePlan turned = planPicture(given(), state);
    EXPECT_EQ(turned.objects_key, first.objects_key);
    EXPECT_EQ(turned.light_key, first.light_key);
    state.light = "sky";
    const PicturePlan lit = planPicture(given(), state);
    EXPECT_EQ(lit.objects_key, first.objects_key);
    EXPECT_NE(lit.light_key, first.light_key);
    state.last_layer = 3;
    EXPECT_NE(planPicture(given(), state).objects_key, first.objects_key);
}

TEST(PicturePlan, ShellLinesKeepTheirWords) {
    EXPECT_EQ(shellLine({"a", "it's", "", "$(x)"}), "a 'it'\\''s' '' '$(x)'");
}

// From above, from 10 km, from a micrometre, from within.
TEST(PicturePlan, ExtremeCamerasHaveRays) {
    for (const char* camera : {R"({"eye": [0, 0, 1000], "look_at": [0, 0, 0], "up": [0, 1, 0]})",
                               R"({"eye": [1e7, 0, 0], "look_at": [0, 0, 0]})",
                               R"({"eye": [0, 0, 1e-3], "look_at": [0, 0, 0], "up": [0, 1, 0]})",
                               R"({"eye": [0, 0, 0], "look_at": [1, 0, 0]})"}) {
        const ViewState state = parseViewState({{"camera", nlohmann::json::parse(camera)}});
        EXPECT_EQ(parseViewState(toJson(state)), state) << camera;
        const trace::Box box{glm::dvec3(-1.0), glm::dvec3(1.0, 2.0, 3.0)};
        const PicturePlan plan = planPicture(given(), state);
        const auto ray = shade::Camera::make(plan.options.scene.camera, box, state.width, state.height).ray({0.5, 0.5});
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_TRUE(std::isfinite(ray.origin[axis])) << camera;
            EXPECT_TRUE(std::isfinite(ray.direction[axis])) << camera;
        }
    }
}

}  // namespace
}  // namespace stratum::view
