#include "shade/integrator/tile.h"

#include "shade/analytic_prints.h"

#include <gtest/gtest.h>

#include <cstring>

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

}  // namespace
}  // namespace stratum
