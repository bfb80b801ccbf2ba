#include "view/input/view_scene.h"

#include "given_tile.h"
#include "view/picture/quick_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

namespace stratum::view {
namespace {

trace::Hit downOn(const trace::Intersector& print, double x, double y) {
    trace::Hit hit;
    hit.t = trace::kInfinity;
    (void)print.makeTracer()->intersect({{x, y, 100.0}, {0.0, 0.0, -1.0}, 0.0, trace::kInfinity}, hit);
    return hit;
}

TEST(ViewScene, AnotherSelectionKeepsTheProgram) {
    Document document(test::givenTile(0.2));
    ViewScene scene(document);
    ViewState state;
    scene.makeObjects(planPicture(document.given(), state), {});
    const auto program = document.toolpath(0);
    ASSERT_TRUE(program);
    state.last_layer = 3;
    const PicturePlan plan = planPicture(document.given(), state);
    EXPECT_FALSE(scene.has(plan));
    EXPECT_TRUE(scene.canStandIn(plan));
    scene.makeObjects(plan, {});
    EXPECT_TRUE(scene.has(plan));
    EXPECT_EQ(document.toolpath(0), program);
    document.forget();
    EXPECT_FALSE(scene.has(plan));
    EXPECT_FALSE(scene.canStandIn(plan));
}

TEST(ViewScene, ColoursKeepTheBricks) {
    Document document(test::givenTile(0.2));
    ViewScene scene(document);
    ViewState state;
    scene.makeObjects(planPicture(document.given(), state), {});
    const ondemand::PrintField* field = &scene.objects().prints.front()->finest();
    state.color_by = "feature";
    scene.makeObjects(planPicture(document.given(), state), {});
    EXPECT_EQ(&scene.objects().prints.front()->finest(), field);
    EXPECT_FALSE(scene.describe()["legends"].empty());
}

TEST(ViewScene, WhatStandsInIsCutAtTheLayers) {
    Document document(test::givenTile(0.2));
    ViewScene scene(document);
    ViewState state;
    scene.makeObjects(planPicture(document.given(), state), {});
    state.first_layer = 2;
    state.last_layer = 3;
    const PicturePlan plan = planPicture(document.given(), state);
    const ViewedPicture picture = scene.standIn(plan, state, 64, 48);
    // Layers are 0.2 mm: from the underside of the second to the middle of the third.
    const trace::Hit hit = downOn(*picture.print, 100.3, 100.1);
    EXPECT_NEAR(hit.position.z, 0.5, 0.11);
    ASSERT_TRUE(picture.scene.bed);
    EXPECT_NEAR(picture.scene.bed->z, 0.2, 1e-6);
}

TEST(QuickPicture, LooksLikeThePicture) {
    Document document(test::givenTile(0.2));
    ViewScene scene(document);
    ViewState state;
    state.named = shade::View::iso;
    const PicturePlan plan = planPicture(document.given(), state);
    scene.makeObjects(plan, {});
    const ViewedPicture picture = scene.picture(plan, 96, 72, ViewScene::Light::near);
    const std::vector<std::uint8_t> quick = quickPicture(picture, *picture.bare_light);
    shade::RenderOptions options = plan.options.render;
    options.width = 96;
    options.height = 72;
    options.aovs.clear();
    options.spp = 16;
    const auto full = shade::toDisplay(shade::render(*picture.print, picture.scene, options).film, picture.tone);
    ASSERT_EQ(quick.size(), full.size());
    double difference = 0.0;
    for (std::size_t n = 0; n < quick.size(); ++n) difference += std::abs(int{quick[n]} - int{full[n]});
    // Shadows are others; a black or a white picture would be 60 and more away.
    EXPECT_LT(difference / static_cast<double>(quick.size()), 25.0);
    EXPECT_EQ(quick, quickPicture(picture, *picture.bare_light));
}

}  // namespace
}  // namespace stratum::view
