#include "mechanics/pieces.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <vector>

namespace stratum::mechanics {
namespace {

// Union-find with path halving; the lowest index is the representative.
class Joined {
public:
    explicit Joined(std::size_t count) : leader_(count) { std::iota(leader_.begin(), leader_.end(), 0U); }
    std::uint32_t find(std::uint32_t e) {
        while (leader_[e] != e) e = leader_[e] = leader_[leader_[e]];
        return e;
    }
    void join(std::uint32_t a, std::uint32_t b) {
        a = find(a);
        b = find(b);
        leader_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<std::uint32_t> leader_;
};

// Joins every element with the one that lies this far from it, both in the list's order: two fingers go up the list.
void joinNeighbours(const std::vector<SolidElement>& list, int dj, int dk, Joined& joined) {
    std::size_t other = 0;
    for (std::size_t n = 0; n < list.size(); ++n) {
        const auto wanted = std::tuple(list[n].k + dk, list[n].j + dj, list[n].i);
        const auto place = [&list](std::size_t m) { return std::tuple(list[m].k, list[m].j, list[m].i); };
        while (other < list.size() && place(other) < wanted) ++other;
        if (other < list.size() && place(other) == wanted)
            joined.join(static_cast<std::uint32_t>(n), static_cast<std::uint32_t>(other));
    }
}

}  // namespace

Pieces keepLargestPiece(SolidElements& elements) {
    std::vector<SolidElement>& list = elements.list;
    Joined joined(list.size());
    for (std::size_t n = 1; n < list.size(); ++n)
        if (std::tuple(list[n - 1].k, list[n - 1].j, list[n - 1].i + 1) == std::tuple(list[n].k, list[n].j, list[n].i))
            joined.join(static_cast<std::uint32_t>(n - 1), static_cast<std::uint32_t>(n));
    joinNeighbours(list, 1, 0, joined);
    joinNeighbours(list, 0, 1, joined);

    std::vector<std::uint32_t> size(list.size());
    Pieces pieces;
    for (std::uint32_t n = 0; n < list.size(); ++n)
        if (size[joined.find(n)]++ == 0) ++pieces.count;
    if (pieces.count < 2) return pieces;
    const auto largest = static_cast<std::uint32_t>(std::max_element(size.begin(), size.end()) - size.begin());
    std::size_t kept = 0;
    for (std::uint32_t n = 0; n < list.size(); ++n)
        if (joined.find(n) == largest) list[kept++] = list[n];
    pieces.removed = list.size() - kept;
    list.resize(kept);
    return pieces;
}

}  // namespace stratum::mechanics
