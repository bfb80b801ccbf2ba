#include "shade/camera/sampler.h"

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <vector>

namespace stratum {
namespace {

using shade::Sampler;
namespace sobol = shade::sobol;

TEST(Sobol, SecondDimensionIsPascalsTriangle) {
    // The textbook form: direction numbers v, v ^ (v >> 1), ...
    for (std::uint32_t index = 0; index < 5000; ++index) {
        std::uint32_t expected = 0;
        std::uint32_t v = 1u << 31;
        for (std::uint32_t i = index; i != 0; i >>= 1, v ^= v >> 1)
            if (i & 1u) expected ^= v;
        ASSERT_EQ(sobol::dimension1(index), expected) << index;
    }
}

TEST(Sobol, ScrambleIsABijectionOfNestedIntervals) {
    // Values that share their first k bits still do, for every k.
    for (std::uint32_t i = 0; i < 2000; ++i) {
        const std::uint32_t a = sobol::hash(i);
        for (unsigned k = 1; k < 32; ++k) {
            const std::uint32_t b = a ^ (1u << (31 - k));  // differs at bit k from the top
            const std::uint32_t d = sobol::owenScramble(a, 99u) ^ sobol::owenScramble(b, 99u);
            ASSERT_EQ(d >> (31 - k), 1u) << i << " " << k;
        }
    }
}

/// All elementary intervals of 2^k boxes hold one of the first 2^k points.
void expectNet(const std::vector<glm::vec2>& points, unsigned k) {
    const std::size_t n = std::size_t{1} << k;
    for (unsigned a = 0; a <= k; ++a) {
        std::vector<int> count(n, 0);
        for (std::size_t i = 0; i < n; ++i) {
            const auto x = static_cast<std::size_t>(points[i].x * static_cast<float>(1u << a));
            const auto y = static_cast<std::size_t>(points[i].y * static_cast<float>(1u << (k - a)));
            ++count[(x << (k - a)) | y];
        }
        for (const int c : count) ASSERT_EQ(c, 1) << "2^" << k << " points, split 2^" << a;
    }
}

TEST(Sampler, EveryPrefixIsANetInEveryDraw) {
    for (const auto& [x, y] : {std::array{0, 0}, std::array{17, 900}, std::array{32767, 3}}) {
        Sampler sampler(5, 256);
        for (int draw = 0; draw < 6; ++draw) {
            std::vector<glm::vec2> points;
            std::vector<float> line;
            for (std::uint32_t s = 0; s < 256; ++s) {
                sampler.start(x, y, s);
                for (int skip = 0; skip < draw; ++skip) sampler.next2D();
                points.push_back(sampler.next2D());
                line.push_back(sampler.next1D());
            }
            for (unsigned k = 0; k <= 8; ++k) {
                expectNet(points, k);
                std::set<int> cells;
                for (std::size_t i = 0; i < (std::size_t{1} << k); ++i)
                    cells.insert(static_cast<int>(line[i] * static_cast<float>(1u << k)));
                ASSERT_EQ(cells.size(), std::size_t{1} << k);
            }
        }
    }
}

TEST(Sampler, NeighboursComplementEachOther) {
    // 4 x 4 pixels of 4 samples are a net of 64 points together.
    Sampler sampler(1, 4);
    std::vector<glm::vec2> points;
    for (int y = 8; y < 12; ++y)
        for (int x = 4; x < 8; ++x)
            for (std::uint32_t s = 0; s < 4; ++s) {
                sampler.start(x, y, s);
                points.push_back(sampler.next2D());
            }
    expectNet(points, 6);
}

TEST(Sampler, IsAPureFunctionOfItsArguments) {
    Sampler a(3, 16);
    Sampler b(3, 16);
    Sampler other(4, 16);
    b.start(1, 2, 3);
    b.next1D();
    int differ = 0;
    for (std::uint32_t s = 0; s < 16; ++s) {
        a.start(70, 9, s);
        b.start(70, 9, s);
        other.start(70, 9, s);
        EXPECT_EQ(a.next2D(), b.next2D());
        const float v = a.next1D();
        EXPECT_EQ(v, b.next1D());
        other.next2D();
        differ += v != other.next1D();
        EXPECT_GE(v, 0.0f);
        EXPECT_LT(v, 1.0f);
    }
    EXPECT_GT(differ, 12);
}

TEST(Sampler, MeansAreAHalfAndDrawsAreUncorrelated) {
    double sum = 0.0;
    double product = 0.0;
    int n = 0;
    Sampler sampler(11, 1);
    for (int y = 0; y < 256; ++y) {
        for (int x = 0; x < 256; ++x, ++n) {
            sampler.start(x, y, 0);
            const double a = static_cast<double>(sampler.next1D());
            const double b = static_cast<double>(sampler.next1D());
            sum += a;
            product += (a - 0.5) * (b - 0.5);
        }
    }
    EXPECT_NEAR(sum / n, 0.5, 1e-3);
    EXPECT_NEAR(product / n * 12.0, 0.0, 0.02);
}

}  // namespace
}  // namespace stratum
