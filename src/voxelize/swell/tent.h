// Sums over squares of nodes, weighted by a tent. In SIMD, with the same bytes on all instruction sets.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace stratum::voxelize {

/// Nodes [x0, x1) x [y0, y1) of a square.
struct NodeBox {
    int x0 = 0, x1 = 0, y0 = 0, y1 = 0;

    bool empty() const { return x0 >= x1 || y0 >= y1; }
    NodeBox grown(int by) const { return {x0 - by, x1 + by, y0 - by, y1 + by}; }
    NodeBox within(const NodeBox& other) const {
        return {std::max(x0, other.x0), std::min(x1, other.x1), std::max(y0, other.y0), std::min(y1, other.y1)};
    }
    static NodeBox all(int edge) { return {0, edge, 0, edge}; }
};

/// Sums weighted by the tent 1 - |n| / (reach + 1) along both axes. Of one thread.
class Tent {
public:
    static constexpr int kMostReach = 4;

    /// `edge`: nodes along each edge of the square.
    explicit Tent(int edge);

    /// `values` and `out` row by row; `reach` at most kMostReach. Values outside `from` count as 0; only the nodes of
    /// `to` are written. Both boxes within the square.
    void sum(const std::vector<float>& values, const NodeBox& from, int reach, const NodeBox& to,
             std::vector<float>& out);

private:
    const int edge_;
    const std::size_t stride_;        // nodes from a row to the next
    std::vector<float> line_, rows_;  // one row with zeros on both sides; sums along rows, with zeros above and below
};

}  // namespace stratum::voxelize
