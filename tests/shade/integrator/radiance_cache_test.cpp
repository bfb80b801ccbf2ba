#include "shade/integrator/radiance_cache.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace stratum {
namespace {

using shade::Color;
using shade::DeepVertex;
using shade::RadianceCache;
using shade::Side;

const trace::Box kBox{{-1.0, -2.0, 0.0}, {3.0, 2.0, 1.0}};

std::vector<DeepVertex> times(std::size_t count, std::uint32_t cell, const Color& throughput, const Color& light) {
    return std::vector<DeepVertex>(count, DeepVertex{cell, 0, throughput, light});
}

TEST(RadianceCache, IsTheMeanWeightedByThroughput) {
    RadianceCache cache(kBox, 32);
    const std::uint32_t cell = cache.cell({0.5, 0.5, 0.5}, {0.0, 0.0, 1.0}, Side::air);
    cache.add(times(30, cell, Color(1.0f, 0.5f, 0.0f), Color(2.0f, 1.0f, 0.0f)), 20);
    cache.add(times(10, cell, Color(0.2f), Color(0.0f)), 10);
    EXPECT_EQ(cache.paths(), 30u);
    EXPECT_EQ(cache.vertices(), 40u);
    EXPECT_EQ(cache.known(), 1u);
    const auto mean = cache.radiance(cell);
    ASSERT_TRUE(mean);
    EXPECT_NEAR(mean->r, 60.0 / 32.0, 1e-5);
    EXPECT_NEAR(mean->g, 30.0 / 17.0, 1e-5);
    EXPECT_EQ(mean->b, 0.0f);
}

TEST(RadianceCache, KnowsNothingOfAFewPaths) {
    RadianceCache cache(kBox, 32);
    const std::uint32_t cell = cache.cell({0.5, 0.5, 0.5}, {0.0, 0.0, 1.0}, Side::air);
    EXPECT_FALSE(cache.radiance(cell));
    cache.add(times(3, cell, Color(1.0f), Color(1.0f)), 3);
    EXPECT_FALSE(cache.radiance(cell));
    EXPECT_EQ(cache.known(), 0u);
}

TEST(RadianceCache, TellsPlaceDirectionAndSideApart) {
    const RadianceCache cache(kBox, 32);
    const auto cell = [&](const glm::dvec3& p, const glm::dvec3& d, Side side) { return cache.cell(p, d, side); };
    const std::uint32_t here = cell({0.5, 0.5, 0.5}, {0.1, 0.2, 0.9}, Side::air);
    EXPECT_EQ(here, cell({0.51, 0.51, 0.51}, {0.3, -0.2, 0.8}, Side::air));
    EXPECT_NE(here, cell({0.65, 0.5, 0.5}, {0.1, 0.2, 0.9}, Side::air));
    EXPECT_NE(here, cell({0.5, 0.5, 0.65}, {0.1, 0.2, 0.9}, Side::air));
    EXPECT_NE(here, cell({0.5, 0.5, 0.5}, {0.1, 0.2, -0.9}, Side::air));
    EXPECT_NE(here, cell({0.5, 0.5, 0.5}, {0.9, 0.2, 0.1}, Side::air));
    EXPECT_NE(here, cell({0.5, 0.5, 0.5}, {0.1, 0.2, 0.9}, Side::solid));
}

TEST(RadianceCache, DrawnPositionsFadeCellsIntoEachOther) {
    const RadianceCache cache(kBox, 32);
    const glm::dvec3 up(0.0, 0.0, 1.0);
    // 1/4 before the face between two cells: a quarter of the draws are beyond it.
    const double size = 4.0 / 32.0;
    const glm::dvec3 p(-1.0 + 7.75 * size, 0.01, 0.51);
    int beyond = 0;
    for (int n = 0; n < 1000; ++n)
        beyond += cache.cellNear(p, up, Side::air, {(n + 0.5) / 1000.0, 0.5, 0.5}) != cache.cell(p, up, Side::air);
    EXPECT_NEAR(beyond, 250, 1);
}

// Surfaces lie on the box, or by rounding beyond it.
TEST(RadianceCache, HoldsWhatLiesBesideItsBox) {
    RadianceCache cache(kBox, 32);
    for (const double far : {1e-12, 1.0, 1e30}) {
        const std::uint32_t low = cache.cell(kBox.min - far, {1.0, 0.0, 0.0}, Side::air);
        const std::uint32_t high = cache.cell(kBox.max + far, {1.0, 0.0, 0.0}, Side::solid);
        cache.add(times(20, low, Color(1.0f), Color(1.0f)), 1);
        cache.add(times(20, high, Color(1.0f), Color(1.0f)), 1);
    }
    EXPECT_EQ(cache.known(), 2u);
}

TEST(RadianceCache, BoxesWithoutASizeHaveOneCell) {
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    for (const trace::Box& box :
         {trace::Box{glm::dvec3(1.0), glm::dvec3(1.0)}, trace::Box{glm::dvec3(kInfinite), glm::dvec3(-kInfinite)}}) {
        const RadianceCache cache(box, 32);
        EXPECT_EQ(cache.cell({1.0, 1.0, 1.0}, {1.0, 0.0, 0.0}, Side::air),
                  cache.cell({7.0, 1.0, 1.0}, {1.0, 0.0, 0.0}, Side::air));
    }
    // A needle has cells along it alone.
    EXPECT_LT(RadianceCache({{0.0, 0.0, 0.0}, {0.0, 0.0, 5.0}}, 32).bytes(), 32u * 12u * 64u);
}

}  // namespace
}  // namespace stratum
