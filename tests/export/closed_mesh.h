// What makes a mesh closed: every edge runs as often one way as the other.
#pragma once

#include "export/mesh/surface_mesh.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <utility>

namespace stratum::test {

/// Besides, no face has a point twice, and no two points of a face are one.
inline void expectClosed(const exporter::SurfaceMesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    mesh.forEachTriangle([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        ASSERT_TRUE(a != b && b != c && c != a);
        ++edges[{a, b}];
        ++edges[{b, c}];
        ++edges[{c, a}];
    });
    for (const auto& [edge, count] : edges) {
        const auto back = edges.find({edge.second, edge.first});
        ASSERT_TRUE(back != edges.end() && back->second == count);
        ASSERT_NE(mesh.points[edge.first], mesh.points[edge.second]);
    }
}

}  // namespace stratum::test
