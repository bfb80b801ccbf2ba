#include "shade/brdf/table_brdf.h"

#include "shade/brdf_checks.h"
#include "shade/measured/scan_interpolant.h"
#include "shade/scan_checks.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <random>
#include <vector>

namespace stratum {
namespace {

using shade::Color;
using shade::HalfDiffTable;
using shade::TableBrdf;

TableBrdf makeTable(double factor) {
    const shade::ScanInterpolant whole(test::knownScan({0, 20, 40, 60}));
    return {
        HalfDiffTable::bake([&](const glm::dvec3& wo, const glm::dvec3& wi) { return factor * whole.eval(wi, wo); }),
        whole.lobes(),
        {"by hand"}};
}

/// As measured, and one that reflects more than it receives.
const TableBrdf& plain() {
    static const TableBrdf brdf = makeTable(1.0);
    return brdf;
}
const TableBrdf& excessive() {
    static const TableBrdf brdf = makeTable(2.0);
    return brdf;
}

constexpr double kTableCosines[] = {0.02, 0.1, 0.3, 0.6, 0.9, 1.0};

TEST(TableBrdf, IsReciprocal) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (const TableBrdf* brdf : {&plain(), &excessive()}) {
        for (int i = 0; i < 20000; ++i) {
            const glm::vec3 a = test::direction(uniform(random), 6.28 * uniform(random));
            const glm::vec3 b = test::direction(uniform(random), 6.28 * uniform(random));
            const Color ab = brdf->eval(a, b);
            const Color ba = brdf->eval(b, a);
            for (int c = 0; c < 3; ++c) ASSERT_NEAR(ab[c], ba[c], 1e-6f * std::max(1.0f, ab[c]));
        }
    }
}

TEST(TableBrdf, AlbedoStaysBelowOne) {
    EXPECT_GT(excessive().tableAlbedo(), 1.1f);
    for (const TableBrdf* brdf : {&plain(), &excessive()})
        for (double c = 0.01; c < 1.0; c += 0.03)
            EXPECT_LE(test::albedo(*brdf, test::direction(c, 0.4), 500, 400), 1.0) << c;
    // What needs no scaling gets none.
    EXPECT_EQ(plain().eval({0, 0, 1}, {0.6f, 0, 0.8f}), plain().table().at({0, 0, 1}, {0.6f, 0, 0.8f}));
}

TEST(TableBrdf, SamplesAgreeWithQuadrature) {
    for (const TableBrdf* brdf : {&plain(), &excessive()})
        for (const double c : {0.1, 0.4, 0.95}) {
            const glm::vec3 wo = test::direction(c, 2.0);
            EXPECT_NEAR(test::sampledAlbedo(*brdf, wo), test::albedo(*brdf, wo, 800, 800), 4e-3) << c;
        }
}

TEST(TableBrdf, SamplesItsDensity) {
    for (const TableBrdf* brdf : {&plain(), &excessive()})
        for (const double c : {0.1, 0.5, 0.95})
            EXPECT_LT(test::chiSquaredZ(*brdf, test::direction(c, 1.0), 300000, 3), 4.0) << c;
}

TEST(TableBrdf, StreamsAreOneByOne) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
    constexpr std::size_t kCount = 1000;
    for (const TableBrdf* brdf : {&plain(), &excessive()}) {
        std::vector<glm::vec3> wo, wi;
        std::vector<float> lobes;
        std::vector<glm::vec2> u;
        for (std::size_t n = 0; n < kCount; ++n) {
            // Some are below the surface, where nothing is reflected.
            wo.push_back(test::direction(n % 13 == 0 ? -0.5 : double(uniform(random)), 6.28 * double(uniform(random))));
            wi.push_back(test::direction(n % 17 == 0 ? -0.2 : double(uniform(random)), 6.28 * double(uniform(random))));
            lobes.push_back(uniform(random));
            u.emplace_back(uniform(random), uniform(random));
        }
        std::vector<Color> values(kCount);
        std::vector<float> densities(kCount);
        std::vector<shade::BrdfSample> samples(kCount);
        brdf->evalStream(wo, wi, values, densities);
        brdf->sampleStream(wo, lobes, u, samples);
        std::size_t drawn = 0;
        for (std::size_t n = 0; n < kCount; ++n) {
            const Color alone = brdf->eval(wo[n], wi[n]);
            for (int c = 0; c < 3; ++c) ASSERT_NEAR(values[n][c], alone[c], 2e-5f * alone[c]) << n;
            ASSERT_EQ(densities[n], brdf->pdf(wo[n], wi[n])) << n;
            const auto sample = brdf->sample(wo[n], lobes[n], u[n]);
            ASSERT_EQ(samples[n].pdf, sample ? sample->pdf : 0.0f) << n;
            if (!sample) continue;
            ++drawn;
            ASSERT_EQ(samples[n].wi, sample->wi) << n;
            for (int c = 0; c < 3; ++c) ASSERT_NEAR(samples[n].f[c], sample->f[c], 2e-5f * sample->f[c]) << n;
        }
        EXPECT_GT(drawn, kCount / 2);
    }
}

TEST(TableBrdf, WhiteFurnace) {
    // A table of 1 / pi is a white Lambert surface, and its scale brings it just below 1.
    const TableBrdf white(HalfDiffTable(std::vector<Color>(HalfDiffTable::kCells, Color(shade::kInvPi))),
                          {{{1.0, 1e-9, 0.3}, {1.0, 1e-9, 0.3}, {1.0, 1e-9, 0.3}}}, {});
    for (const double c : kTableCosines)
        EXPECT_NEAR(test::albedo(white, test::direction(c, 0.3), 300, 300), 1.0, 0.012);
}

TEST(TableBrdf, IsFiniteAtTheEdges) {
    for (const float z : {1e-30f, 1e-12f, 1e-6f, 1e-3f, 1.0f}) {
        const glm::vec3 wo(std::sqrt(1.0f - z * z), 0.0f, z);
        for (const glm::vec3& wi : {glm::vec3(-wo.x, 0.0f, z), glm::vec3(wo.x, 0.0f, z), glm::vec3(0, 0, 1)}) {
            EXPECT_TRUE(shade::isFinite(plain().eval(wo, wi))) << z;
            EXPECT_TRUE(std::isfinite(plain().pdf(wo, wi)));
        }
        for (const float u : {0.0f, 0.3f, 0x1.fffffep-1f}) {
            const auto s = plain().sample(wo, u, {u, u});
            if (!s) continue;
            EXPECT_GT(s->pdf, 0.0f);
            EXPECT_TRUE(shade::isFinite(s->f * (s->wi.z / s->pdf)));
        }
    }
    EXPECT_EQ(plain().eval({0, 0, 1}, {0, 0, -1}), Color(0.0f));
    EXPECT_FALSE(plain().sample({0, 0, -1}, 0.5f, {0.5f, 0.5f}));
    EXPECT_EQ(plain().notes().at(0), "by hand");
}

}  // namespace
}  // namespace stratum
