#include "voxelize/leaf/owner_kernels.h"

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace stratum::voxelize {
namespace {

struct Nearest {
    PlanField least;
    PlanOwners owners;
};

// The rule of the header, sample by sample.
void takeNearerPlainly(const OwnedLayer& layer, Nearest& nearest) {
    for (std::size_t c = 0; c < kColumnSamples; ++c) {
        float over = layer.over;
        if (layer.rise != nullptr)
            over = std::max(std::min(layer.dz - layer.rise->v[c], 2 * layer.dz), 0.0F) - layer.half_side;
        const float above = std::max(over, 0.0F);
        float distance = std::sqrt(layer.sides2->v[c] + above * above) - layer.radius;
        if (layer.d != nullptr) distance += std::min(std::max(layer.d->v[c], over), 0.0F);
        float& least = nearest.least.v[c];
        std::uint32_t& owner = nearest.owners.v[c];
        if (!(distance < least || (distance == least && layer.owners->v[c] < owner))) continue;
        least = distance;
        owner = layer.owners->v[c];
    }
}

TEST(OwnerKernels, TheNearestLayerAndOfEqualOnesTheEarlierBeadOnEveryInstructionSet) {
    for (std::int64_t rest = hwy::SupportedTargets() & ~HWY_DISABLED_TARGETS; rest != 0; rest &= rest - 1) {
        hwy::SetSupportedTargetsForTest(rest & -rest);
        std::mt19937 random(3);
        // In few steps, so that many distances are equal.
        const auto number = [&random] { return 0.05F * static_cast<float>(random() % 7); };
        Nearest found{};
        std::fill(std::begin(found.least.v), std::end(found.least.v), 1e38F);
        Nearest expected = found;
        for (std::uint32_t n = 0; n < 200; ++n) {
            PlanField sides2;
            PlanField d;
            PlanField rise;
            PlanOwners owners;
            for (std::size_t c = 0; c < kColumnSamples; ++c) {
                sides2.v[c] = 0.9F * number() + (n < 100 ? 1.0F : 0.0F);
                d.v[c] = number() - 0.2F;
                rise.v[c] = number() - 0.1F;
                owners.v[c] = static_cast<std::uint32_t>(random() % 9) + (n % 2) * 0x90000000U;
            }
            const OwnedLayer layer{.sides2 = &sides2,
                                   .d = n % 3 == 0 ? &d : nullptr,
                                   .rise = n % 5 == 0 ? &rise : nullptr,
                                   .owners = &owners,
                                   .radius = 0.1F,
                                   .half_side = 0.05F,
                                   .dz = number(),
                                   .over = number() - 0.1F};
            takeNearer(layer, found.least, found.owners);
            takeNearerPlainly(layer, expected);
            for (std::size_t c = 0; c < kColumnSamples; ++c) {
                ASSERT_EQ(found.least.v[c], expected.least.v[c]) << n;
                ASSERT_EQ(found.owners.v[c], expected.owners.v[c]) << n;
            }
        }
    }
    hwy::SetSupportedTargetsForTest(0);
}

}  // namespace
}  // namespace stratum::voxelize
