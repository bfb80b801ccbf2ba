// A rectangle of nodes.
#pragma once

#include <algorithm>

namespace stratum::voxelize {

/// Nodes [x0, x1) x [y0, y1) of a square.
struct NodeBox {
    int x0 = 0, x1 = 0, y0 = 0, y1 = 0;

    bool empty() const { return x0 >= x1 || y0 >= y1; }
    bool has(int x, int y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
    /// The least box with both in it.
    NodeBox with(const NodeBox& other) const {
        if (empty() || other.empty()) return empty() ? other : *this;
        return {std::min(x0, other.x0), std::max(x1, other.x1), std::min(y0, other.y0), std::max(y1, other.y1)};
    }
    NodeBox moved(int x, int y) const { return {x0 + x, x1 + x, y0 + y, y1 + y}; }
    NodeBox grown(int by) const { return {x0 - by, x1 + by, y0 - by, y1 + by}; }
    NodeBox within(const NodeBox& other) const {
        return {std::max(x0, other.x0), std::min(x1, other.x1), std::max(y0, other.y0), std::min(y1, other.y1)};
    }
    static NodeBox all(int edge) { return {0, edge, 0, edge}; }
};

}  // namespace stratum::voxelize
