#include "assemble/picture_request.h"

#include "base/error.h"
#include "base/options/json_section.h"
#include "refusal.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <string>

namespace stratum::assemble {
namespace {

// Options as any place gives them; here that of JSON, with the names that Python has.
void read(const char* text, PictureRequest& request) {
    const auto json = nlohmann::json::parse(text);
    const std::string name = "options";
    JsonSection options(json, "", name);
    readPicture(options, request);
}

TEST(PictureRequest, WhatComesLaterTakesThePlaceOfWhatSaysTheSame) {
    PictureRequest request;
    read(R"({"eye": [1, 2, 3], "look_at": [0, 0, 0], "f_number": 4, "focus": 7, "env": "a.hdr", "env_exposure": 2,
             "color": "red,blue", "denoise": true, "clip": [0, 0, 1, 3]})",
         request);
    EXPECT_EQ(request.exposure, 0.0);
    EXPECT_EQ(request.tool_colors.size(), 2U);
    read(R"({"view": "top", "aperture": 5, "focus": [1, 2, 3], "env": "studio", "brdf": "pla-blue",
             "integrator": "depth", "clip": [1, 0, 0, 1, 0, 1, 0, 2]})",
         request);
    EXPECT_EQ(request.scene.camera.view, shade::View::top);
    EXPECT_FALSE(request.scene.camera.eye || request.scene.camera.look_at);
    EXPECT_EQ(request.scene.camera.f_number, 0);
    EXPECT_EQ(request.scene.camera.aperture, 5);
    EXPECT_FALSE(request.scene.camera.focus_distance);
    EXPECT_TRUE(request.scene.camera.focus_point);
    EXPECT_EQ(request.scene.env_exposure, 0);
    EXPECT_FALSE(request.exposure);
    EXPECT_TRUE(request.tool_colors.empty());
    EXPECT_EQ(request.scene.brdf, "pla-blue");
    EXPECT_FALSE(request.denoise);
    EXPECT_EQ(request.tracing.clip.size(), 2U);
    EXPECT_NO_THROW(request.scene.camera.validate());
}

TEST(PictureRequest, LeavesAloneWhatIsNotGiven) {
    PictureRequest request;
    request.scene.camera.eye = glm::dvec3(1, 2, 3);
    request.exposure = -1;
    read("{}", request);
    EXPECT_TRUE(request.scene.camera.eye);
    EXPECT_EQ(request.exposure, -1.0);
    EXPECT_FALSE(request.spp_given);
    EXPECT_EQ(request.scene.env, "studio");
}

TEST(PictureRequest, SamplesReachAnErrorOrATime) {
    PictureRequest request;
    read(R"({"noise": 0.1})", request);
    completeSamples(request);
    EXPECT_EQ(request.render.spp, 4096);
    PictureRequest given;
    read(R"({"noise": 0.1, "spp": 32})", given);
    completeSamples(given);
    EXPECT_EQ(given.render.spp, 32);
}

TEST(PictureRequest, RefusesWhatMeansNothing) {
    for (const char* text : {R"({"view": "side"})", R"({"size": [1]})", R"({"spp": 0})", R"({"phong": [1, 2]})",
                             R"({"clip": [1, 2, 3]})", R"({"color_range": [1, 2]})", R"({"brdf": "a", "color": "red"})",
                             R"({"march": "sphere", "brick_cache": "1MB"})", R"({"focus": [1, 2]})"}) {
        PictureRequest request;
        EXPECT_THROW(read(text, request), InputError) << text;
    }
}

TEST(PictureRequest, RefusesWhatExcludesEachOther) {
    const auto refused = [](const char* text, const char* words) {
        PictureRequest request;
        EXPECT_TRUE(test::refuses<InputError>(words, [&] {
            const auto json = nlohmann::json::parse(text);
            const std::string name = "options";
            JsonSection options(json, "", name);
            readPicture(options, request);
            refuseUnused(options, request);
        })) << text;
    };
    refused(R"({"color": "red", "color_by": "layer"})", "color: expected no color_by beside it");
    refused(R"({"color": "red", "brdf": "pla-blue"})", "color: expected no brdf beside it");
    refused(R"({"view": "top", "eye": [1, 2, 3]})", "view: expected no eye beside it");
    refused(R"({"photograph": {}, "view": "top"})", "photograph: expected no view beside it");
    refused(R"({"photograph": {}, "fov": 30})", "photograph: expected no fov beside it");
}

TEST(PictureRequest, AColorTakesThePlaceOfColorsByAnAttribute) {
    PictureRequest request;
    read(R"({"color_by": "speed", "color_range": [2, 9]})", request);
    read(R"({"color": "red"})", request);
    EXPECT_TRUE(request.scene.color_by.empty());
    EXPECT_FALSE(request.scene.color_range);
}

TEST(PictureRequest, TellsWhatTakesThePlaceOfAPhotograph) {
    PictureRequest request;
    request.photograph = true;
    read(R"({"fov": 30, "zoom": 2})", request);
    ASSERT_EQ(request.notes.size(), 1U);
    EXPECT_NE(request.notes[0].find("fov takes the place of what the scene's photograph tells"), std::string::npos);
    EXPECT_EQ(request.scene.camera.fov, 30);
}

}  // namespace
}  // namespace stratum::assemble
