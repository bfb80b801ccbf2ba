#include "mechanics/hexahedra.h"

#include "base/error.h"

#include <gtest/gtest.h>

#include <set>
#include <tuple>

namespace stratum::mechanics {
namespace {

SolidElements someCubes() {
    std::uint32_t seed = 3;
    std::set<std::tuple<int, int, int>> places;
    for (int n = 0; n < 300; ++n) {
        seed = seed * 1664525U + 1013904223U;
        // A gap in the planes, and negative places.
        const int k = static_cast<int>(seed >> 8 & 7);
        places.insert({k < 4 ? k : k + 3, static_cast<int>(seed >> 16 & 7) - 4, static_cast<int>(seed >> 24 & 15) - 8});
    }
    SolidElements elements;
    elements.edge = 0.5;
    for (const auto& [k, j, i] : places) elements.list.push_back({i, j, k, 0});
    return elements;
}

TEST(Hexahedra, HaveTheCornersOfTheirCubes) {
    const SolidElements elements = someCubes();
    const Hexahedra mesh = hexahedraOf(elements, 1000000);
    ASSERT_EQ(mesh.corners.size(), elements.list.size());
    constexpr int kOffsets[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                    {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    std::set<std::uint32_t> used;
    for (std::size_t n = 0; n < mesh.corners.size(); ++n)
        for (std::size_t c = 0; c < 8; ++c) {
            const std::uint32_t number = mesh.corners[n][c];
            used.insert(number);
            ASSERT_LT(number, mesh.nodes.size());
            const Node& node = mesh.nodes[number];
            const SolidElement& e = elements.list[n];
            ASSERT_EQ(node.i, e.i + kOffsets[c][0]);
            ASSERT_EQ(node.j, e.j + kOffsets[c][1]);
            ASSERT_EQ(node.k, e.k + kOffsets[c][2]);
        }
    EXPECT_EQ(used.size(), mesh.nodes.size()) << "a node that no element has";
    for (std::size_t n = 1; n < mesh.nodes.size(); ++n) {
        const Node& a = mesh.nodes[n - 1];
        const Node& b = mesh.nodes[n];
        ASSERT_LT(std::tie(a.k, a.j, a.i), std::tie(b.k, b.j, b.i));
    }
}

TEST(Hexahedra, TooManyNodesAreRefused) {
    const SolidElements elements = someCubes();
    const std::size_t nodes = hexahedraOf(elements, 1000000).nodes.size();
    EXPECT_EQ(hexahedraOf(elements, nodes).nodes.size(), nodes);
    EXPECT_THROW(hexahedraOf(elements, nodes - 1), UsageError);
}

TEST(Hexahedra, NothingHasNone) { EXPECT_TRUE(hexahedraOf({}, 8).nodes.empty()); }

}  // namespace
}  // namespace stratum::mechanics
