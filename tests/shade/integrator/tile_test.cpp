#include "shade/integrator/render.h"

#include "shade/analytic_prints.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <tuple>
#include <utility>

namespace stratum {
namespace {

TEST(TilesOf, CoverARegionOnce) {
    const shade::PixelBox region{5, 7, 80, 41};
    std::vector<int> seen(100 * 100, 0);
    for (const shade::PixelBox& box : shade::tilesOf(region))
        for (int y = box.y0; y < box.y1; ++y)
            for (int x = box.x0; x < box.x1; ++x) ++seen[std::size_t(y * 100 + x)];
    for (int y = 0; y < 100; ++y)
        for (int x = 0; x < 100; ++x)
            ASSERT_EQ(seen[std::size_t(y * 100 + x)], x >= 5 && x < 80 && y >= 7 && y < 41 ? 1 : 0);
}

TEST(Tile, SamplesInTwoGoesAreThoseInOne) {
    const auto ball = test::sphere({0, 0, 0}, 1.0);
    const auto scene = shade::makeScene({}, ball, 20, 20);
    const shade::AovRecorder recorder(scene, ball, shade::parseAovs("normal,variance,samples"));
    const auto integrator = shade::makeIntegrator({}, scene, ball);
    const shade::PixelFilter filter;
    const auto filmOf = [&](std::vector<int> targets) {
        shade::TileWorker worker{ball.makeTracer(), shade::Sampler(3, 32), {}, {}, {}, {}, {}};
        shade::Tile tile({2, 3, 18, 17}, recorder);
        for (const int target : targets) tile.sample(target, scene.camera, *integrator, recorder, filter, worker);
        EXPECT_EQ(tile.samples(), 32);
        EXPECT_GT(tile.error(), 0.0);
        shade::Film film(20, 20, {0, 0, 20, 20});
        film.layers() = shade::makeLayers(shade::parseAovs("normal,variance,samples"), 400);
        tile.store(film);
        return film;
    };
    const shade::Film once = filmOf({32});
    const shade::Film twice = filmOf({4, 8, 32});
    EXPECT_EQ(0, std::memcmp(once.pixels().data(), twice.pixels().data(), 400 * sizeof(shade::Pixel)));
    for (std::size_t layer = 0; layer < 3; ++layer)
        EXPECT_EQ(once.layers()[layer].values, twice.layers()[layer].values);
}

/// Half of the light is even, the other half comes by one sample in many, as from a small lamp that is met by chance.
/// The mean of every pixel is 1.
class Spikes final : public shade::RayIntegrator {
public:
    /// @param rare  the share of the samples that meet the lamp
    Spikes(const shade::SceneDescription& scene, const trace::Intersector& print, float rare)
        : RayIntegrator(scene, print), rare_(rare) {}

protected:
    shade::Pixel seen(const trace::Ray&, const shade::SurfacePoint*, shade::TraceContext& context) const override {
        // Hashed: samples that are met by chance do not come in strata.
        const auto bits = std::bit_cast<std::uint32_t>(context.sampler.next1D());
        const bool met = shade::sobol::toFloat(shade::sobol::hash(bits, 7)) < rare_;
        return {shade::Color(0.5f + (met ? 0.5f / rare_ : 0.0f)), 1.0f};
    }

private:
    float rare_;
};

/// A tile of them, sampled as --noise does.
struct SpikyTile {
    static constexpr int kMost = 4096;
    static constexpr shade::PixelBox kBox{0, 0, shade::kTile, shade::kTile};

    SpikyTile(float rare, std::uint32_t seed)
        : integrator(scene, none, rare),
          worker{none.makeTracer(), shade::Sampler(seed, kMost), {}, {}, {}, {}, {}},
          tile(kBox, recorder) {}
    void sample(int target) { tile.sample(target, scene.camera, integrator, recorder, filter, worker); }
    void sampleUntil(double asked) {
        sample(16);
        while (tile.samples() < kMost && tile.error() > asked) sample(2 * tile.samples());
    }
    /// Of the pixels from 1: root mean square, and mean.
    std::pair<double, double> off() const {
        shade::Film film(shade::kTile, shade::kTile, kBox);
        tile.store(film);
        double squares = 0.0;
        double sum = 0.0;
        for (const shade::Pixel& pixel : film.pixels()) {
            const double d = double(pixel.rgb.g) - 1.0;
            squares += d * d;
            sum += d;
        }
        const auto count = double(film.pixels().size());
        return {std::sqrt(squares / count), sum / count};
    }

    test::FunctionIntersector none = test::nothing();
    shade::SceneDescription scene = shade::makeScene({}, none, shade::kTile, shade::kTile);
    shade::AovRecorder recorder{scene, none, {}};
    Spikes integrator;
    shade::PixelFilter filter;
    shade::TileWorker worker;
    shade::Tile tile;
};

// Divided by each pixel's own mean, the variance of 16 samples says 0.12 here, where the error is 4.
TEST(Tile, KnowsTheErrorOfRareBrightSamples) {
    constexpr double kAsked = 0.5;
    for (std::uint32_t seed = 1; seed <= 6; ++seed) {
        SpikyTile spiky(1e-3f, seed);
        spiky.sample(16);
        EXPECT_NEAR(spiky.tile.error() / spiky.off().first, 1.0, 0.25) << seed;
        spiky.sampleUntil(kAsked);
        EXPECT_LT(spiky.tile.samples(), SpikyTile::kMost);
        EXPECT_LT(spiky.off().first, 1.2 * kAsked) << seed;
        EXPECT_GT(spiky.off().first, 0.5 * kAsked) << seed;
    }
}

// Whether a tile goes on depends on what it has met, so tiles that stop are a little too dark. docs/shading.md has the
// figures.
TEST(Tile, StoppingBySamplesLeavesABias) {
    constexpr std::uint32_t kSeeds = 24;
    for (const auto& [rare, least, most] :
         {std::tuple{1e-3f, -0.02, 0.02}, std::tuple{1e-4f, -0.25, 0.0}, std::tuple{1e-5f, -0.5, -0.25}}) {
        double bias = 0.0;
        double samples = 0.0;
        for (std::uint32_t seed = 1; seed <= kSeeds; ++seed) {
            SpikyTile spiky(rare, seed);
            spiky.sampleUntil(0.5);
            bias += spiky.off().second / kSeeds;
            samples += double(spiky.tile.samples()) / kSeeds;
        }
        std::printf("met by one sample in %.0f: bias %+.3f, mean samples %.0f\n", 1.0 / double(rare), bias, samples);
        EXPECT_GT(bias, least) << rare;
        EXPECT_LT(bias, most) << rare;
    }
}

}  // namespace
}  // namespace stratum
