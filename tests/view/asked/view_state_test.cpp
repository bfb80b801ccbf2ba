#include "view/asked/view_state.h"

#include "base/error.h"

#include <gtest/gtest.h>

#include <string>

namespace stratum::view {
namespace {

using Json = nlohmann::json;

void expectRefused(const char* text) {
    SCOPED_TRACE(text);
    EXPECT_THROW((void)parseViewState(Json::parse(text)), InputError);
}

TEST(ViewState, AnEmptyOneIsAsGiven) {
    const ViewState state = parseViewState(Json::object());
    EXPECT_EQ(state, ViewState());
    EXPECT_FALSE(state.named);
    EXPECT_FALSE(state.eye);
    EXPECT_TRUE(state.material.empty());
}

TEST(ViewState, WhatIsWrittenIsReadAgain) {
    const char* text = R"({"size": [640, 360], "camera": {"eye": [1.5, -200, 0.1], "look_at": [0, 0, 3], "fov": 40},
        "layers": [3, 9], "printed": 12.5, "by_time": true, "hidden_features": ["skirt", "infill"], "objects": [2, 1, 2],
        "tools": [1], "color_by": "feature", "color_range": [-1.5, 20], "material": "pla-blue", "light": "sky:25,30", "light_rotation": -20,
        "exposure": 1.5, "bed": true, "bed_surface": "grid", "smooth": true, "clip": [0, 0, 1, 4.5],
        "integrator": "direct", "spp": 64})";
    const ViewState state = parseViewState(Json::parse(text));
    EXPECT_EQ(state.width, 640);
    EXPECT_EQ(state.eye->y, -200.0);
    EXPECT_EQ(state.first_layer, 3U);
    EXPECT_EQ(state.last_layer, 9U);
    EXPECT_EQ(state.printed, 12.5);
    EXPECT_EQ(state.objects, (std::vector<std::uint32_t>{1, 2}));  // each once
    EXPECT_EQ(state.clip->offset, 4.5);
    EXPECT_EQ(state.bed_surface, shade::BedSurface::grid);
    EXPECT_EQ(parseViewState(toJson(state)), state);
    EXPECT_FALSE(parseViewState(Json::object()) == state);
    ViewState named;
    named.named = shade::View::top;
    EXPECT_EQ(parseViewState(toJson(named)).named, shade::View::top);
}

TEST(ViewState, AllIsPrintedAt100PerCent) { EXPECT_FALSE(parseViewState(Json::parse(R"({"printed": 100})")).printed); }

TEST(ViewState, NoTextNamesAFile) {
    for (const char* path : {"/etc/passwd", "../secret.bsdf", "./pla-blue", "map.hdr", "data/brdf/pla-blue.bsdf.gz"}) {
        SCOPED_TRACE(path);
        EXPECT_THROW((void)parseViewState({{"material", path}}), InputError);
        EXPECT_THROW((void)parseViewState({{"light", path}}), InputError);
        EXPECT_THROW((void)parseViewState({{"color_by", path}}), InputError);
        EXPECT_THROW((void)parseViewState({{"integrator", path}}), InputError);
    }
    EXPECT_EQ(parseViewState({{"material", "#ff8800"}}).material, "#ff8800");
    EXPECT_EQ(parseViewState({{"material", "teal"}}).material, "teal");
}

TEST(ViewState, WhatMakesNoPictureIsRefused) {
    for (const char* text : {"[]",
                             "3",
                             R"({"size": [0, 9]})",
                             R"({"size": [1e9, 9]})",
                             R"({"size": [8000, 8000]})",
                             R"({"size": [100.5, 90]})",
                             R"({"size": "9x9"})",
                             R"({"unknown": 1})",
                             R"({"camera": []})",
                             R"({"camera": {"view": "inside"}})",
                             R"({"camera": {"eye": [1, 2, 3]}})",
                             R"({"camera": {"eye": [1e30, 2, 3], "look_at": [0, 0, 0]}})",
                             R"({"camera": {"view": "top", "eye": [1, 2, 3], "look_at": [0, 0, 0]}})",
                             R"({"camera": {"fov": 0}})",
                             R"({"layers": [5, 2]})",
                             R"({"layers": [-1, 2]})",
                             R"({"layers": [1.5, 2]})",
                             R"({"layers": [1]})",
                             R"({"printed": 0})",
                             R"({"printed": 101})",
                             R"({"printed": "half"})",
                             R"({"hidden_features": ["legs"]})",
                             R"({"hidden_features": "skirt"})",
                             R"({"objects": [-1]})",
                             R"({"tools": [256]})",
                             R"({"tools": [0.5]})",
                             R"({"color_by": "feature,layer"})",
                             R"({"color_range": [1, 2]})",
                             R"({"color_by": "speed", "color_range": [2, 2]})",
                             R"({"color_by": "speed", "color_range": [0, 1e30]})",
                             R"({"light_rotation": 1e4})",
                             R"({"exposure": 99})",
                             R"({"bed": "no"})",
                             R"({"bed_surface": "wood"})",
                             R"({"clip": [0, 0, 0, 1]})",
                             R"({"clip": [0, 0, 1]})",
                             R"({"clip": [0, 0, 1, 1e300]})",
                             R"({"spp": 100000})",
                             R"({"smooth": 1})"})
        expectRefused(text);
    EXPECT_THROW((void)parseViewState({{"objects", std::vector<int>(5000, 1)}}), InputError);
    EXPECT_THROW((void)parseViewState({{"material", std::string(10000, 'a')}}), InputError);
}

TEST(ViewState, ANumberOfBeadsIsPrinted) {
    const ViewState state = parseViewState(Json::parse(R"({"beads": 1234, "printed": 100})"));
    EXPECT_EQ(state.beads, 1234U);
    EXPECT_EQ(parseViewState(toJson(state)), state);
}

}  // namespace
}  // namespace stratum::view
