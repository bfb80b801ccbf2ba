#include "mechanics/solid_elements.h"

#include "mechanics/pieces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

namespace stratum::mechanics {
namespace {

using Place = std::tuple<int, int, int>;  // k, j, i

CubeShares cubesOf(const std::map<Place, float>& shares) {
    CubeShares cubes;
    cubes.edge = 1;
    for (const auto& [place, share] : shares) {
        const auto& [k, j, i] = place;
        cubes.list.push_back({i, j, k, share, 0x3f});
        cubes.plastic += static_cast<double>(share);
    }
    return cubes;
}

SolidElements elementsOf(const CubeShares& cubes, const std::vector<std::uint32_t>& chosen) {
    SolidElements elements;
    elements.edge = 1;
    for (const std::uint32_t n : chosen)
        elements.list.push_back({cubes.list[n].i, cubes.list[n].j, cubes.list[n].k, 0});
    return elements;
}

std::size_t piecesOf(const CubeShares& cubes, const std::vector<std::uint32_t>& chosen) {
    SolidElements elements = elementsOf(cubes, chosen);
    return keepLargestPiece(elements).count;
}

TEST(ChosenCubes, OfFullOnesAreAll) {
    std::map<Place, float> shares;
    for (int n = 0; n < 1000; ++n) shares[{n / 100 - 5, n / 10 % 10 - 5, n % 10 - 5}] = 1;
    EXPECT_EQ(chosenCubes(cubesOf(shares)).size(), 1000U);
}

TEST(ChosenCubes, HoldThePlasticOfAThickBodyWithRaggedSides) {
    std::map<Place, float> shares;
    std::uint32_t seed = 5;
    for (int k = -12; k <= 12; ++k)
        for (int j = -12; j <= 12; ++j)
            for (int i = -12; i <= 12; ++i) {
                seed = seed * 1664525U + 1013904223U;
                const double depth = 12 - std::sqrt(i * i + j * j + k * k);
                if (depth > 0) shares[{k, j, i}] = depth < 1 ? static_cast<float>(seed >> 8) / 16777216.0F : 1.0F;
            }
    const CubeShares cubes = cubesOf(shares);
    const auto chosen = chosenCubes(cubes);
    EXPECT_NEAR(static_cast<double>(chosen.size()), cubes.plastic, 1);
    EXPECT_EQ(piecesOf(cubes, chosen), 1U);
}

// Walls of three fifths of a cube, every fifth cube: half of their cubes hold their plastic, and yet all is one piece.
TEST(ChosenCubes, HoldThinWallsTogether) {
    std::map<Place, float> shares;
    for (int k = 0; k < 40; ++k)
        for (int j = 0; j < 40; ++j)
            for (int i = 0; i < 40; ++i)
                if (j % 5 == 0 || i % 5 == 0) shares[{k, j, i}] = 0.6F;
    const CubeShares cubes = cubesOf(shares);
    const auto chosen = chosenCubes(cubes);
    EXPECT_NEAR(static_cast<double>(chosen.size()) / cubes.plastic, 1, 0.01);
    EXPECT_EQ(piecesOf(cubes, chosen), 1U);
}

// Two bodies and a thread between them, which no block would choose.
TEST(ChosenCubes, KeepAThreadBetweenTwoBodies) {
    std::map<Place, float> shares;
    for (int n = 0; n < 512; ++n) {
        shares[{n / 64, n / 8 % 8, n % 8}] = 1;
        shares[{n / 64, n / 8 % 8, n % 8 + 24}] = 1;
    }
    for (int i = 8; i < 24; ++i) shares[{4, 4, i}] = 0.05F;
    CubeShares cubes = cubesOf(shares);
    const auto chosen = chosenCubes(cubes);
    EXPECT_EQ(piecesOf(cubes, chosen), 1U);
    EXPECT_NEAR(static_cast<double>(chosen.size()), cubes.plastic, 1);
    // Not where the plastic itself is cut: it ends before the face between two cubes.
    for (CubeShare& cube : cubes.list)
        if (cube.i == 16) cube.reached &= static_cast<std::uint8_t>(~(1U << x_low));
    EXPECT_EQ(piecesOf(cubes, chosenCubes(cubes)), 2U);
}

// A line of cubes a third full cannot lose any: more than the plastic, but one piece.
TEST(ChosenCubes, OfALoneThreadAreMoreThanItsPlastic) {
    std::map<Place, float> shares;
    for (int i = 0; i < 40; ++i) shares[{0, 0, i}] = 0.33F;
    const CubeShares cubes = cubesOf(shares);
    EXPECT_EQ(piecesOf(cubes, chosenCubes(cubes)), 1U);
}

TEST(ChosenCubes, OfNothingAreNone) { EXPECT_TRUE(chosenCubes(CubeShares{}).empty()); }

}  // namespace
}  // namespace stratum::mechanics
