#include "assemble/ready_scene.h"

#include "base/error.h"
#include "prints.h"
#include "trace/sdf.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace stratum::assemble {
namespace {

PictureOptions smallPicture() {
    PictureOptions options;
    options.tracing = test::coarseTracing();
    options.render.width = 40;
    options.render.height = 30;
    options.render.spp = 1;
    return options;
}

const std::string kTilePrint = (test::sourceDir() / "data/gcode/tile.gcode").string();

TEST(ReadyScene, APrintIsAPicture) {
    const PictureOptions options = smallPicture();
    const ReadyScene ready = readyScene(kTilePrint, options);
    EXPECT_TRUE(ready.scene.bed);
    EXPECT_EQ(ready.tone.exposure, 0.0);  // the studio is bright enough
    ASSERT_TRUE(ready.objects.part);
    EXPECT_EQ(ready.middle, 0.5 * (ready.objects.part->min + ready.objects.part->max));
    // What the camera is fitted to lies in the middle of the picture.
    const auto seen = ready.scene.camera.project(ready.middle);
    ASSERT_TRUE(seen);
    EXPECT_NEAR(seen->x, 20.0, 6.0);
    EXPECT_NEAR(seen->y, 15.0, 6.0);
    const shade::RenderResult result = shade::render(*ready.objects.intersector, ready.scene, options.render);
    const auto& pixels = result.film.pixels();
    const auto [least, most] = std::minmax_element(pixels.begin(), pixels.end(),
                                                   [](const auto& a, const auto& b) { return a.rgb.b < b.rgb.b; });
    EXPECT_GT(most->rgb.b, 2 * least->rgb.b);  // a white bed, an orange print
}

TEST(ReadyScene, ThePaperMindsTheFilament) {
    PictureOptions options = smallPicture();
    const auto paper = [&](const char* material) {
        options.scene.brdf = material;
        return readyScene(kTilePrint, options).scene.bed->texture.mean().g;
    };
    const float light = shade::BedTexture(shade::BedSurface::paper).mean().g;
    EXPECT_EQ(paper("#101010"), light);
    EXPECT_EQ(paper("#d8563b"), light);
    for (const char* pale : {"#f4f4f4", "#c0c0c0", "clear-petg"}) EXPECT_LT(paper(pale), 0.5f * light) << pale;
    options.scene.bed_surface = shade::BedSurface::grid;
    EXPECT_EQ(paper("#f4f4f4"), shade::BedTexture(shade::BedSurface::grid).mean().g);
}

TEST(ReadyScene, VoxelsAreAsFineAsPixelsAsk) {
    PictureOptions options = smallPicture();
    options.tracing.prints.print.lattice.voxel_size.reset();
    options.tracing.prints.print.voxel_auto = true;
    const ReadyScene ready = readyScene(kTilePrint, options);
    const auto& report = ready.objects.reports[0];
    ASSERT_TRUE(report.contains("voxel_auto"));
    EXPECT_GT(report["voxel_auto"]["smallest_pixel_mm"], 0.1);
    ObjectOptions moved = test::objectOf(kTilePrint);
    moved.placement.offset.x = 1;
    EXPECT_THROW((void)readyScene({moved}, options), UsageError);
}

TEST(ReadyScene, DarkLightIsShownBrighter) {
    ObjectOptions ball;
    ball.sdf = trace::sdfSphere({0, 0, 5}, 5);
    PictureOptions options = smallPicture();
    options.scene.env = "constant:0.1,0.1,0.1";
    EXPECT_GT(readyScene({ball}, options).tone.exposure, 1.0);
    options.find_exposure = false;
    EXPECT_EQ(readyScene({ball}, options).tone.exposure, 0.0);
}

TEST(ReadyScene, RefusesBadOptions) {
    PictureOptions options = smallPicture();
    options.render.width = 0;
    EXPECT_THROW((void)readyScene(kTilePrint, options), UsageError);
    options = smallPicture();
    options.scene.env = "moon";
    EXPECT_ANY_THROW((void)readyScene(kTilePrint, options));
    EXPECT_THROW((void)readyScene("no such file.gcode"), InputError);
}

}  // namespace
}  // namespace stratum::assemble
