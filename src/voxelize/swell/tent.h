// Sums over squares of nodes, weighted by a tent. In SIMD, with the same bytes on all instruction sets.
#pragma once

#include "voxelize/swell/node_box.h"

#include <cstddef>
#include <vector>

namespace stratum::voxelize {

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
