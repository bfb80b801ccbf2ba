// Sets of numbered things that are joined step by step.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace stratum {

/// Union-find with path halving; the lowest number of a set is its representative.
class UnionFind {
public:
    explicit UnionFind(std::size_t count) : leader_(count) { std::iota(leader_.begin(), leader_.end(), 0U); }
    std::uint32_t find(std::uint32_t e) {
        while (leader_[e] != e) e = leader_[e] = leader_[leader_[e]];
        return e;
    }
    /// False if they were joined already.
    bool join(std::uint32_t a, std::uint32_t b) {
        a = find(a);
        b = find(b);
        leader_[std::max(a, b)] = std::min(a, b);
        return a != b;
    }

private:
    std::vector<std::uint32_t> leader_;
};

}  // namespace stratum
