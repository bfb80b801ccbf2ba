// Sums over squares of nodes, weighted by a tent. In SIMD, with the same bytes on all instruction sets.
#pragma once

#include <cstddef>
#include <vector>

namespace stratum::voxelize {

/// Sums weighted by the tent 1 - |n| / (reach + 1) along both axes. Nodes outside the square count as 0. Of one thread.
class Tent {
public:
    static constexpr int kMostReach = 4;

    /// `edge`: nodes along each edge of the square.
    explicit Tent(int edge);

    /// `values` and `out` row by row; `reach` at most kMostReach.
    void sum(const std::vector<float>& values, int reach, std::vector<float>& out);

private:
    const int edge_;
    const std::size_t stride_;         // nodes from a row to the next, with zeros around the square
    std::vector<float> given_, rows_;  // padded: the values, and their sums along rows
};

}  // namespace stratum::voxelize
