#include "shade/environment/map_stream.h"

#include "on_each_target.h"
#include "shade/camera/sampling.h"
#include "shade/environment/scalar_map.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace stratum {
namespace {

using shade::BilinearDistribution;
using shade::Color;
using shade::EnvironmentSample;

/// Noise with, on request, a sun of one texel that outshines it by far, and its tables: of the noise by normals or
/// without, and of the sun.
class NoisyMap {
public:
    NoisyMap(int height, bool sun, double rotation, bool by_normal = true)
        : map_{2 * height, height, {}}, rotation_(rotation) {
        std::mt19937 random(7);
        std::uniform_real_distribution<float> uniform(0.0f, 2.0f);
        for (int n = 0; n < 2 * height * height; ++n) map_.texels.emplace_back(uniform(random), uniform(random), 0.5f);
        // A dark piece, where nothing may be drawn.
        for (int y = height / 2; y < height; ++y)
            for (int x = 0; x < height; ++x) map_.texels[static_cast<std::size_t>(y * 2 * height + x)] = Color(0.0f);
        std::vector<float> weights;
        for (const Color& texel : map_.texels) weights.push_back(shade::luminance(texel));
        const auto direction = [rotation](const glm::dvec2& uv) {
            double sine = 0.0;
            return test::directionOf(uv, rotation, sine);
        };
        tables_.emplace_back(weights, 2 * height, height, by_normal ? direction : BilinearDistribution::Direction{});
        if (!sun) return;
        const auto place = static_cast<std::size_t>(height / 3 * 2 * height + height);
        map_.texels[place] = Color(1e5f);
        std::fill(weights.begin(), weights.end(), 0.0f);
        weights[place] = 1e5f;
        tables_.emplace_back(weights, 2 * height, height);
    }
    shade::PlacedMap placed() const { return {map_, rotation_, tables_}; }

private:
    shade::LightMap map_;
    double rotation_;
    std::vector<BilinearDistribution> tables_;
};

struct Draws {
    std::vector<glm::vec2> u;
    std::vector<glm::vec3> normals;
};

/// Draws for normals all over the sphere, the ends of both ranges among them.
Draws manyDraws(std::size_t count) {
    Draws draws;
    std::mt19937 random(11);
    std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
    const float last = 1.0f - 0x1p-24f;
    for (std::size_t n = 0; n < count; ++n) {
        draws.u.emplace_back(n % 17 == 0 ? last : uniform(random), n % 19 == 0 ? 0.0f : uniform(random));
        draws.normals.push_back(shade::toSphere({uniform(random), uniform(random)}));
    }
    return draws;
}

class MapStream : public test::OnEachTarget {
protected:
    static void expectSame(const EnvironmentSample& a, const EnvironmentSample& b) {
        if (b.pdf == 0.0f) {
            ASSERT_EQ(a.pdf, 0.0f);
            return;
        }
        for (int k = 0; k < 3; ++k) {
            ASSERT_NEAR(a.direction[k], b.direction[k], 1e-7f);
            ASSERT_NEAR(a.radiance[k], b.radiance[k], 1e-3f * b.radiance[k] + 1e-6f);
        }
        ASSERT_NEAR(a.pdf, b.pdf, 1e-3f * b.pdf + 1e-6f);
    }
    /// All that the streams say, against one call at a time.
    static void expectOneByOne(const NoisyMap& map) {
        const shade::PlacedMap placed = map.placed();
        for (const std::size_t count : {1u, 63u, 64u, 5000u}) {
            const Draws draws = manyDraws(count);
            std::vector<EnvironmentSample> samples(count);
            std::vector<EnvironmentSample> there(count);
            std::vector<glm::vec3> ways(count);
            for (int strategy = 0; strategy < static_cast<int>(placed.tables.size()); ++strategy) {
                shade::sampleMap(placed, strategy, draws.u, draws.normals, samples);
                for (std::size_t n = 0; n < count; ++n) {
                    expectSame(samples[n], test::sampleOne(placed, strategy, draws.u[n], draws.normals[n]));
                    if (HasFatalFailure()) FAIL() << strategy << ", " << n;
                }
            }
            // Not where samples lie: some are on the edges of cells, where rounding decides.
            for (std::size_t n = 0; n < count; ++n) ways[n] = draws.normals[(7 * n + 3) % count];
            shade::evalMap(placed, ways, draws.normals, there);
            for (std::size_t n = 0; n < count; ++n) {
                expectSame(there[n], test::evalOne(placed, ways[n], draws.normals[n]));
                if (HasFatalFailure()) FAIL() << "eval, " << n;
            }
            std::vector<Color> seen(count);
            shade::mapRadiance(placed, ways, seen);
            for (std::size_t n = 0; n < count; ++n) ASSERT_EQ(seen[n], there[n].radiance) << n;
        }
    }
};

INSTANTIATE_TEST_SUITE_P(Targets, MapStream, test::allTargets(), test::targetName);

TEST_P(MapStream, IsOneByOneForManyMaps) {
    // Blocks of one cell and of many, cut ones at the ends.
    for (const int height : {2, 16, 50, 200}) {
        expectOneByOne(NoisyMap(height, false, 0.0));
        if (HasFatalFailure()) FAIL() << height;
    }
    // Blocks with more cells a side than are compared at once.
    expectOneByOne(NoisyMap(1040, false, 0.0));
    expectOneByOne(NoisyMap(50, false, -13.7));
    expectOneByOne(NoisyMap(64, true, 1.1));
    expectOneByOne(NoisyMap(64, true, 0.4, false));
}

TEST_P(MapStream, LooksStraightUpAndDown) {
    const NoisyMap map(32, false, 0.3);
    const std::vector<glm::vec3> ways = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {0, -1, 0}, {-1, -0.0f, 0}};
    const std::vector<glm::vec3> normals(ways.size(), glm::vec3(0, 0, 1));
    std::vector<EnvironmentSample> there(ways.size());
    shade::evalMap(map.placed(), ways, normals, there);
    for (std::size_t n = 0; n < ways.size(); ++n) {
        const EnvironmentSample alone = test::evalOne(map.placed(), ways[n], normals[n]);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(there[n].radiance[k], alone.radiance[k], 1e-4f) << n;
        EXPECT_NEAR(there[n].pdf, alone.pdf, 1e-3f * alone.pdf) << n;
    }
    EXPECT_EQ(there[0].pdf, 0.0f);  // a pole has no density
}

TEST_P(MapStream, HasTheSameBitsOnEveryProcessor) {
    const NoisyMap map(50, true, 0.9);
    const Draws draws = manyDraws(1000);
    const auto all = [&] {
        std::vector<EnvironmentSample> samples(2000);
        shade::sampleMap(map.placed(), 0, draws.u, draws.normals, std::span(samples).first(1000));
        shade::evalMap(map.placed(), draws.normals, draws.normals, std::span(samples).last(1000));
        return samples;
    };
    const auto here = all();
    hwy::SetSupportedTargetsForTest(HWY_EMU128);
    const auto there = all();
    for (std::size_t n = 0; n < here.size(); ++n) {
        ASSERT_EQ(here[n].direction, there[n].direction) << n;
        ASSERT_EQ(here[n].radiance, there[n].radiance) << n;
        ASSERT_EQ(here[n].pdf, there[n].pdf) << n;
    }
}

}  // namespace
}  // namespace stratum
