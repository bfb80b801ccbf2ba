#include "mechanics/pieces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <tuple>

namespace stratum::mechanics {
namespace {

using Place = std::tuple<int, int, int>;  // k, j, i

SolidElements elementsAt(std::set<Place> places) {
    SolidElements elements;
    elements.edge = 1;
    for (const auto& [k, j, i] : places) elements.list.push_back({i, j, k, 0});
    return elements;
}

TEST(Pieces, OneStaysWhole) {
    SolidElements elements = elementsAt({{0, 0, 0}, {0, 0, 1}, {0, 1, 1}, {1, 1, 1}});
    const Pieces pieces = keepLargestPiece(elements);
    EXPECT_EQ(pieces.count, 1U);
    EXPECT_EQ(pieces.removed, 0U);
    EXPECT_EQ(elements.list.size(), 4U);
}

TEST(Pieces, AnEdgeJoinsNothing) {
    SolidElements elements = elementsAt({{0, 0, 0}, {0, 1, 1}, {0, 1, 2}, {1, 0, 1}, {1, 2, 1}});
    const Pieces pieces = keepLargestPiece(elements);
    EXPECT_EQ(pieces.count, 4U);
    EXPECT_EQ(pieces.removed, 3U);
    ASSERT_EQ(elements.list.size(), 2U);
    EXPECT_EQ(elements.list.front().i, 1);
    EXPECT_EQ(elements.list.front().j, 1);
}

// Beside a search that goes from cube to cube.
TEST(Pieces, AgreeWithAFlood) {
    std::uint32_t seed = 7;
    std::set<Place> places;
    for (int n = 0; n < 400; ++n) {
        seed = seed * 1664525U + 1013904223U;
        places.insert(
            {static_cast<int>(seed >> 8 & 7), static_cast<int>(seed >> 16 & 7), static_cast<int>(seed >> 24 & 15)});
    }
    std::set<Place> left = places;
    std::size_t count = 0;
    std::size_t largest = 0;
    while (!left.empty()) {
        ++count;
        std::vector<Place> open{*left.begin()};
        left.erase(left.begin());
        std::size_t size = 0;
        while (!open.empty()) {
            const auto [k, j, i] = open.back();
            open.pop_back();
            ++size;
            for (const Place& next : {Place{k - 1, j, i}, Place{k + 1, j, i}, Place{k, j - 1, i}, Place{k, j + 1, i},
                                      Place{k, j, i - 1}, Place{k, j, i + 1}})
                if (left.erase(next) > 0) open.push_back(next);
        }
        largest = std::max(largest, size);
    }
    SolidElements elements = elementsAt(places);
    const Pieces pieces = keepLargestPiece(elements);
    EXPECT_GT(count, 3U);
    EXPECT_EQ(pieces.count, count);
    EXPECT_EQ(elements.list.size(), largest);
    EXPECT_EQ(pieces.removed, places.size() - largest);
}

// A wipe tower may be larger than the part.
TEST(Pieces, TheLargestIsThatOfTheBeadsThatCount) {
    SolidElements elements = elementsAt({{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 5, 0}, {0, 5, 1}, {0, 9, 0}});
    for (SolidElement& e : elements.list) e.bead = e.j == 0 ? 1 : 2;
    SolidElements others = elements;
    EXPECT_EQ(keepLargestPiece(elements, [](std::uint32_t bead) { return bead == 2; }).removed, 4U);
    ASSERT_EQ(elements.list.size(), 2U);
    EXPECT_EQ(elements.list.front().j, 5);
    EXPECT_EQ(keepLargestPiece(others, [](std::uint32_t) { return false; }).removed, 3U);
}

TEST(Pieces, NothingIsNoPiece) {
    SolidElements none;
    EXPECT_EQ(keepLargestPiece(none).count, 0U);
}

}  // namespace
}  // namespace stratum::mechanics
