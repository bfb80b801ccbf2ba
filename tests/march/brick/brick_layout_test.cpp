#include "march/brick/brick_layout.h"

#include "on_each_target.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <vector>

namespace stratum::march {
namespace {

class BrickLayout : public test::OnEachTarget {};

INSTANTIATE_TEST_SUITE_P(Targets, BrickLayout, test::allTargets(), test::targetName);

TEST_P(BrickLayout, RoundsToTheNearestQuantumAndKeepsSigns) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> value(-0.35F, 0.35F);
    std::vector<float> samples(LeafSource::kLeafSamples);
    const float scale = 32767 / 0.3F;
    const float hard[] = {0.0F, -0.0F, 1e-9F, -1e-9F, 1e-30F,       -1e-30F,
                          0.3F, -0.3F, 5.0F,  -5.0F,  0.5F / scale, -0.5F / scale};
    for (std::size_t n = 0; n < samples.size(); ++n) samples[n] = n < std::size(hard) ? hard[n] : value(random);
    const auto out = std::make_unique<LeafSamples<std::int16_t>>();
    ASSERT_TRUE(convert(samples.data(), scale, *out));
    for (std::size_t n = 0; n < samples.size(); ++n) {
        const std::int16_t q = out->value[n];
        ASSERT_EQ(q < 0, samples[n] < 0) << samples[n];
        ASSERT_EQ(q, convert(samples[n], scale, std::int16_t{})) << samples[n];
        ASSERT_EQ((out->inside[n / 64] >> (n % 64) & 1) != 0, samples[n] < 0);
        const double exact =
            std::clamp(static_cast<double>(samples[n]) * static_cast<double>(scale), -32767.0, 32767.0);
        ASSERT_LE(std::abs(sampleOf(q) - exact), 0.503);
    }
    const auto floats = std::make_unique<LeafSamples<float>>();
    ASSERT_TRUE(convert(samples.data(), 1, *floats));
    EXPECT_TRUE(std::equal(samples.begin(), samples.end(), floats->value.begin()));
    EXPECT_EQ(floats->inside, out->inside);
    CapSamples<std::int16_t> cap;
    ASSERT_TRUE(convert(samples.data(), scale, cap));
    for (std::size_t n = 0; n < LeafSource::kCapSamples; ++n) {
        ASSERT_EQ(cap.value[n], out->value[n]);
        ASSERT_EQ((cap.inside[n / 8] >> (8 * (n % 8)) & 1) != 0, samples[n] < 0);
    }
    for (const std::uint64_t word : cap.inside) EXPECT_EQ(word & ~std::uint64_t{0x0101010101010101}, 0U);
}

TEST_P(BrickLayout, TellsSamplesThatAreNoNumbers) {
    std::vector<float> samples(LeafSource::kLeafSamples, 0.1F);
    const auto quanta = std::make_unique<LeafSamples<std::int16_t>>();
    const auto floats = std::make_unique<LeafSamples<float>>();
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                            -std::numeric_limits<float>::infinity()})
        for (const std::size_t place : {0U, 5U, 100U, 511U}) {
            samples[place] = bad;
            EXPECT_FALSE(convert(samples.data(), 1, *quanta));
            EXPECT_FALSE(convert(samples.data(), 1, *floats));
            CapSamples<std::int16_t> cap;
            EXPECT_EQ(convert(samples.data(), 1, cap), place >= LeafSource::kCapSamples);
            samples[place] = 0.1F;
        }
    EXPECT_TRUE(convert(samples.data(), 1, *quanta));
}

// A brick before another one is the same whether it reads the other's leaf or what the other brick shares of it.
TEST(BrickLayoutOfNeighbours, IsThatOfTheirLeaves) {
    std::mt19937 random(4);
    std::uniform_real_distribution<float> value(-0.3F, 0.3F);
    const float scale = 32767 / 0.3F;
    const auto randomLeaf = [&](LeafSamples<std::int16_t>& leaf, CapSamples<std::int16_t>& above) {
        std::vector<float> samples(LeafSource::kLeafSamples + LeafSource::kCapSamples);
        for (float& sample : samples) sample = value(random);
        ASSERT_TRUE(convert(samples.data(), scale, leaf));
        ASSERT_TRUE(convert(samples.data() + LeafSource::kLeafSamples, scale, above));
    };
    struct Leaf {
        LeafSamples<std::int16_t> samples{};
        CapSamples<std::int16_t> above{};
    };
    const auto leaves = std::make_unique<std::array<Leaf, 5>>();  // four of one brick, and one that is only in part
    Leaf& part_of = leaves->back();
    for (int n = 0; n < 20; ++n) {
        BrickParts<std::int16_t> parts;
        for (std::size_t part = 0; part < 4; ++part) {
            Leaf& leaf = (*leaves)[part];
            ASSERT_NO_FATAL_FAILURE(randomLeaf(leaf.samples, leaf.above));
            parts.leaf[part] = &leaf.samples;
            parts.cap[part] = Cap<std::int16_t>(leaf.above);
        }
        std::vector<std::int16_t> expected(729);
        layOut(parts, expected.data());
        for (std::size_t part = 1; part < 4; ++part) {
            SCOPED_TRACE(part);
            BrickParts<std::int16_t> next;
            next.leaf[0] = parts.leaf[part];
            next.cap[0] = parts.cap[part];
            std::vector<std::int16_t> brick(729);
            layOut(next, brick.data());
            // Whatever is not written must not matter.
            part_of.samples.value.fill(static_cast<std::int16_t>(n % 2 == 0 ? 30000 : -30000));
            part_of.samples.inside.fill(n % 2 == 0 ? 0 : ~std::uint64_t{0});
            copyShared(brick.data(), part, part_of.samples, part_of.above);
            BrickParts<std::int16_t> shared = parts;
            shared.leaf[part] = &part_of.samples;
            shared.cap[part] = Cap<std::int16_t>(part_of.above);
            std::vector<std::int16_t> found(729);
            layOut(shared, found.data());
            EXPECT_EQ(found, expected);
            EXPECT_EQ(surfaceOf(shared), surfaceOf(parts));
        }
    }
}

}  // namespace
}  // namespace stratum::march
