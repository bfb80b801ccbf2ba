#include "shade/integrator/render.h"

#include "base/error.h"
#include "shade/analytic_prints.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>

namespace stratum {
namespace {

using shade::RenderOptions;
using shade::RenderResult;

RenderOptions smallOptions() {
    RenderOptions options;
    options.width = 72;
    options.height = 50;
    options.spp = 4;
    return options;
}

RenderResult renderWith(std::size_t threads, const RenderOptions& options) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    test::Vase vase;
    vase.layers = 40;
    const auto print = vase.intersector();
    return shade::render(print, shade::makeScene({}, print, options.width, options.height), options);
}

bool sameBytes(const shade::Film& a, const shade::Film& b) {
    return a.pixels().size() == b.pixels().size() &&
           std::memcmp(a.pixels().data(), b.pixels().data(), a.pixels().size() * sizeof(shade::Pixel)) == 0;
}

TEST(Render, SameBytesForAnyNumberOfThreads) {
    const RenderResult one = renderWith(1, smallOptions());
    const RenderResult two = renderWith(2, smallOptions());
    const RenderResult four = renderWith(4, smallOptions());
    EXPECT_TRUE(sameBytes(one.film, two.film));
    EXPECT_TRUE(sameBytes(one.film, four.film));
    EXPECT_EQ(one.rays, two.rays);
    EXPECT_EQ(one.rays, four.rays);
    EXPECT_EQ(one.rays.primary, 72u * 50u * 4u);
    EXPECT_GT(one.rays.shadow, 0u);
    EXPECT_GT(one.rays.bounce, 0u);
}

TEST(Render, SeedChangesTheNoiseOnly) {
    RenderOptions options = smallOptions();
    options.spp = 16;
    const RenderResult a = renderWith(2, options);
    options.seed = 1;
    const RenderResult b = renderWith(2, options);
    EXPECT_FALSE(sameBytes(a.film, b.film));
    double difference = 0.0;
    double sum = 0.0;
    for (std::size_t i = 0; i < a.film.pixels().size(); ++i) {
        difference += double(a.film.pixels()[i].rgb.g - b.film.pixels()[i].rgb.g);
        sum += double(a.film.pixels()[i].rgb.g);
    }
    EXPECT_LT(std::abs(difference / sum), 0.002);
}

TEST(Render, CropIsAPartOfTheSamePicture) {
    RenderOptions options = smallOptions();
    const RenderResult whole = renderWith(2, options);
    options.crop = shade::PixelBox{13, 7, 60, 44};
    const RenderResult part = renderWith(2, options);
    EXPECT_EQ(part.film.region(), *options.crop);
    for (int y = 7; y < 44; ++y)
        for (int x = 13; x < 60; ++x) {
            ASSERT_EQ(part.film.at(x, y).rgb, whole.film.at(x, y).rgb) << x << " " << y;
            ASSERT_EQ(part.film.at(x, y).alpha, whole.film.at(x, y).alpha);
        }
}

TEST(Render, CropIsAPartOfTheSamePictureWhenTilesDecide) {
    RenderOptions options = smallOptions();
    options.spp = 64;
    options.noise = 0.05;
    const RenderResult whole = renderWith(2, options);
    options.crop = shade::PixelBox{20, 10, 50, 40};  // across four tiles, none of them whole
    options.margin = 3;
    const RenderResult part = renderWith(2, options);
    const shade::PixelBox kept{17, 7, 53, 43};
    ASSERT_EQ(part.film.region(), kept);
    EXPECT_TRUE(sameBytes(part.film, whole.film.part(kept)));
}

TEST(Render, EveryIntegratorIsFinite) {
    for (const char* name : {"path", "direct", "ao", "normal", "depth"}) {
        RenderOptions options = smallOptions();
        options.integrator.name = name;
        const RenderResult result = renderWith(2, options);
        for (const shade::Pixel& p : result.film.pixels()) {
            ASSERT_TRUE(shade::isFinite(p.rgb)) << name;
            ASSERT_TRUE(p.alpha >= 0.0f && p.alpha <= 1.0f) << name;
        }
    }
}

TEST(Render, ReportsProgressOncePerTileUpToTheEnd) {
    const auto none = test::nothing();
    const RenderOptions options = smallOptions();
    std::uint64_t last = 0;
    int calls = 0;
    shade::render(none, shade::makeScene({}, none, 72, 50), options, [&](std::uint64_t done, std::uint64_t total) {
        EXPECT_GT(done, last);
        EXPECT_EQ(total, 72u * 50u);
        last = done;
        ++calls;
    });
    EXPECT_EQ(last, 72u * 50u);
    EXPECT_EQ(calls, 6);
    EXPECT_THROW(shade::render(none, shade::makeScene({}, none, 72, 50), options,
                               [](std::uint64_t, std::uint64_t) { throw std::runtime_error("stop"); }),
                 std::runtime_error);
}

TEST(Render, ByTheClockEveryPixelGetsSamplesAndTheWorstGetMost) {
    const auto ball = test::sphere({0, 0, 0}, 1.0);
    RenderOptions options;
    options.width = options.height = 128;
    options.spp = 64;
    options.aovs = shade::parseAovs("samples");
    options.seconds = 1e-9;  // over before it began
    const auto scene = shade::makeScene({}, ball, 128, 128);
    const RenderResult least = shade::render(ball, scene, options);
    for (const float n : least.film.layers()[0].values) ASSERT_EQ(n, 4.0f);
    options.seconds = 1e3;  // over when all have --spp
    options.noise = 0.05;
    const RenderResult most = shade::render(ball, scene, options);
    float fewest = 1e9f;
    float largest = 0.0f;
    for (const float n : most.film.layers()[0].values) {
        fewest = std::min(fewest, n);
        largest = std::max(largest, n);
    }
    EXPECT_LT(fewest, largest);
    EXPECT_EQ(most.rays.primary, std::uint64_t(std::llround(most.mean_spp * 128 * 128)));
}

TEST(RenderOptions, RefusesNonsense) {
    const auto broken = [](auto change) {
        RenderOptions options = smallOptions();
        change(options);
        EXPECT_THROW(options.validate(), UsageError);
    };
    broken([](RenderOptions& o) { o.width = 0; });
    broken([](RenderOptions& o) { o.height = 40000; });
    broken([](RenderOptions& o) { o.spp = 0; });
    broken([](RenderOptions& o) { o.spp = 70000; });
    broken([](RenderOptions& o) { o.crop = shade::PixelBox{0, 0, 73, 50}; });
    broken([](RenderOptions& o) { o.crop = shade::PixelBox{5, 5, 5, 9}; });
    const auto none = test::nothing();
    EXPECT_THROW(shade::render(none, shade::makeScene({}, none, 10, 10), smallOptions()), UsageError);
}

}  // namespace
}  // namespace stratum
