#include "view/picture/still_picture.h"

#include "given_tile.h"
#include "scratch_folder.h"
#include "shade/film/picture.h"
#include "shade/post/denoise.h"
#include "view/input/document.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace stratum::view {
namespace {

ViewState smallView() {
    ViewState state;
    state.width = 150;
    state.height = 140;  // no multiple of a tile, several bands
    state.named = shade::View::iso;
    state.spp = 2;
    return state;
}

/// What vdbtrace does with the plan: one render, one file.
std::vector<std::uint8_t> fileOf(const GivenInput& given, const PicturePlan& plan, const std::string& path) {
    const assemble::ReadyScene ready = assemble::readyScene(given.objects, plan.options);
    shade::RenderResult result = shade::render(*ready.objects.intersector, ready.scene, plan.options.render);
    if (plan.denoise) shade::denoise(result.film);
    shade::Metadata metadata = assemble::metadataOf("tile.gcode", plan.options.render, plan.options.scene.env,
                                                    ready.objects, ready.scene, result, plan.denoise);
    metadata.insert(assemble::exposureFact(ready.tone));
    shade::PictureFile(path).write(result.film, metadata, ready.tone);
    const std::string bytes = test::bytesOf(path);
    return {bytes.begin(), bytes.end()};
}

void finish(StillPicture& picture) {
    while (!picture.done()) picture.traceBand([] {});
    picture.finish([] {});
}

TEST(StillPicture, HasTheBytesOfThePictureInOne) {
    const test::ScratchFolder folder;
    Document document(test::givenTile(0.2));
    ViewScene scene(document);
    for (const bool layers : {false, true}) {
        SCOPED_TRACE(layers);
        ViewState state = smallView();
        if (layers) {
            state.last_layer = 4;
            state.color_by = "feature";
            state.light = "sky:30,10";
            state.clip = trace::ClipPlane{{1.0, 0.0, 0.0}, 100.0};
        }
        const PicturePlan plan = planPicture(document.given(), state);
        EXPECT_TRUE(plan.denoise);
        scene.makeObjects(plan, {});
        // Moving pictures come between, of another size.
        (void)scene.picture(plan, 40, 30, ViewScene::Light::near);
        StillPicture picture(scene.picture(plan, state.width, state.height), plan, "tile.gcode", scene.sharedObjects());
        finish(picture);
        EXPECT_EQ(picture.png(), fileOf(document.given(), plan, (folder / "tile.png").string()));
    }
}

TEST(StillPicture, GoesOnWhereItWasPutOff) {
    Document document(test::givenTile(0.2));
    ViewScene scene(document);
    const PicturePlan plan = planPicture(document.given(), smallView());
    scene.makeObjects(plan, {});
    const ViewedPicture viewed = scene.picture(plan, 150, 140);
    StillPicture straight(viewed, plan, "tile.gcode", scene.sharedObjects());
    finish(straight);
    StillPicture halting(viewed, plan, "tile.gcode", scene.sharedObjects());
    // Put off after one tile, then after two, and so on: in the end every piece gets done.
    int calls = 0;
    int patience = 0;
    int put_off = 0;
    const auto sometimes = [&] {
        if (++calls <= patience) return;
        ++put_off;
        ++patience;
        calls = 0;
        throw std::runtime_error("put off");
    };
    for (int attempt = 0; attempt < 200; ++attempt) {
        try {
            if (halting.done()) {
                halting.finish(sometimes);
                break;
            }
            halting.traceBand(sometimes);
        } catch (const std::runtime_error&) {
        }
    }
    EXPECT_GT(put_off, 5);
    ASSERT_TRUE(halting.done());
    EXPECT_EQ(halting.png(), straight.png());
}

}  // namespace
}  // namespace stratum::view
