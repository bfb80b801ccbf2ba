#include "shade/environment/normal_bins.h"

#include "shade/camera/sampling.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace stratum {
namespace {

using shade::NormalBins;

TEST(NormalBins, ANormalLiesInItsBin) {
    for (int bin = 0; bin < NormalBins::kCount; ++bin)
        for (const glm::vec2 place : {glm::vec2(0.5f, 0.5f), {0.1f, 0.1f}, {0.9f, 0.2f}, {0.3f, 0.9f}})
            EXPECT_EQ(NormalBins::of(NormalBins::normal(bin, place)), bin);
}

TEST(NormalBins, CornersGoRoundTheirBin) {
    // No normal is further from its bin's middle than the furthest corner, by a rounding.
    for (int n = 0; n < 20000; ++n) {
        const glm::vec3 normal = shade::toSphere(
            {(static_cast<float>(n) + 0.5f) / 20000.0f, std::fmod(0.618034f * static_cast<float>(n), 1.0f)});
        const int bin = NormalBins::of(3.0f * normal);
        EXPECT_EQ(bin, NormalBins::of(normal));
        const glm::vec3 middle = NormalBins::normal(bin, {0.5f, 0.5f});
        float widest = 1.0f;
        for (const glm::vec2 place : {glm::vec2(0, 0), {1, 0}, {0, 1}, {1, 1}})
            widest = std::min(widest, glm::dot(middle, NormalBins::normal(bin, place)));
        EXPECT_GT(glm::dot(middle, normal), widest - 1e-5f);
        EXPECT_GT(widest, 0.96f);
    }
}

TEST(NormalBins, AxesAndZerosOfBothSigns) {
    for (const glm::vec3 axis : {glm::vec3(0, 0, 1), {0, 0, -1}, {-0.0f, 0.0f, -1}, {1, 0, -0.0f}, {0, -1, 0}}) {
        const int bin = NormalBins::of(axis);
        ASSERT_TRUE(bin >= 0 && bin < NormalBins::kCount);
        EXPECT_GT(glm::dot(NormalBins::normal(bin, {0.5f, 0.5f}), axis), 0.96f);
    }
}

}  // namespace
}  // namespace stratum
