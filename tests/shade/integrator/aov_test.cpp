#include "shade/integrator/aov.h"

#include "base/error.h"
#include "scratch_folder.h"
#include "shade/analytic_prints.h"
#include "shade/film/exr.h"
#include "shade/integrator/render.h"

#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>

namespace stratum {
namespace {

using shade::Aov;

shade::RenderResult renderedLayers(const shade::RenderOptions& options) {
    static const auto ball = test::sphere({0, 0, 0}, 1.0);
    shade::SceneOptions scene_options;
    scene_options.brdf = "lambert:0.5,0.25,0.125";
    scene_options.bed = false;
    const auto scene = shade::makeScene(scene_options, ball, options.width, options.height);
    return shade::render(ball, scene, options);
}

TEST(Aov, ReadsNames) {
    EXPECT_EQ(shade::parseAovs("normal,depth,normal"), (std::vector<Aov>{Aov::normal, Aov::depth}));
    EXPECT_TRUE(shade::parseAovs("").empty());
    EXPECT_THROW(shade::parseAovs("normals"), UsageError);
    EXPECT_THROW(shade::parseAovs("normal,,depth"), UsageError);
}

TEST(Aov, LayersHoldWhatTheCameraSees) {
    shade::RenderOptions options;
    options.width = options.height = 33;
    options.spp = 16;
    options.aovs = shade::parseAovs("normal,depth,position,albedo,mask,variance,samples");
    const auto result = renderedLayers(options);
    const auto& layers = result.film.layers();
    ASSERT_EQ(layers.size(), 7u);
    const std::size_t middle = result.film.index(16, 16);
    const std::size_t corner = result.film.index(0, 0);
    const auto at = [&](std::size_t layer, std::size_t pixel, std::size_t c) {
        return layers[layer].values[pixel * layers[layer].channels.size() + c];
    };
    // On the unit sphere a normal is its position.
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(at(0, middle, c), at(2, middle, c), 1e-4f);
    EXPECT_GT(at(1, middle, 0), 1.0f);
    EXPECT_NEAR(at(3, middle, 1), 0.25f, 1e-5f);
    EXPECT_EQ(at(4, middle, 0), 1.0f);
    EXPECT_GT(at(5, middle, 0), 0.0f);
    EXPECT_EQ(at(6, middle, 0), 16.0f);
    for (std::size_t layer = 0; layer < 5; ++layer) EXPECT_EQ(at(layer, corner, 0), 0.0f);

    const test::ScratchFolder scratch;
    shade::writeExr(scratch / "t.exr", result.film, {});
    Imf::InputFile file((scratch / "t.exr").c_str());
    for (const char* name : {"R", "A", "normal.X", "depth.Z", "position.Y", "albedo.B", "mask.V", "variance.V"})
        EXPECT_TRUE(file.header().channels().findChannel(name)) << name;
}

TEST(Aov, ChangeNothingOfThePicture) {
    shade::RenderOptions options;
    options.width = options.height = 24;
    options.spp = 4;
    const auto plain = renderedLayers(options);
    options.aovs = shade::parseAovs("normal,variance");
    const auto layered = renderedLayers(options);
    for (std::size_t n = 0; n < plain.film.pixels().size(); ++n)
        ASSERT_EQ(plain.film.pixels()[n].rgb, layered.film.pixels()[n].rgb);
    EXPECT_TRUE(plain.film.layers().empty());
    EXPECT_EQ(plain.rays, layered.rays);  // what a camera ray meets is looked up once
    options.spp = 1;
    EXPECT_THROW(renderedLayers(options), UsageError);
}

TEST(Aov, NoiseStopsWhereItIsAskedTo) {
    shade::RenderOptions options;
    options.width = options.height = 64;
    options.spp = 512;
    // Of the worst tile.
    const auto error = [](const shade::RenderResult& result) {
        const auto& film = result.film;
        double worst = 0.0;
        for (const shade::PixelBox& box : shade::tilesOf({0, 0, 64, 64})) {
            double variance = 0.0;
            double sum = 0.0;
            for (int y = box.y0; y < box.y1; ++y)
                for (int x = box.x0; x < box.x1; ++x) {
                    sum += double(shade::luminance(film.at(x, y).rgb));
                    variance += double(film.layers()[0].values[film.index(x, y)]);
                }
            const double count = double(box.width()) * box.height();
            worst = std::max(worst, std::sqrt(variance / count / (sum * sum / (count * count) + 0.01)));
        }
        return worst;
    };
    options.aovs = {Aov::variance};
    options.noise = 0.04;
    const auto coarse = renderedLayers(options);
    options.noise = 0.02;
    const auto fine = renderedLayers(options);
    EXPECT_LE(error(coarse), 0.04001);  // the layer has floats
    EXPECT_LE(error(fine), 0.02001);
    EXPECT_LT(coarse.mean_spp, fine.mean_spp);
    EXPECT_GE(coarse.mean_spp, 16.0);
    EXPECT_LE(fine.mean_spp, 512.0);
    options.noise = 2.0;
    EXPECT_THROW(renderedLayers(options), UsageError);
}

}  // namespace
}  // namespace stratum
