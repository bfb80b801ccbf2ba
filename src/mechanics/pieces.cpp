#include "mechanics/pieces.h"

#include "base/union_find.h"
#include "mechanics/cube_neighbors.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace stratum::mechanics {

Pieces keepLargestPiece(SolidElements& elements, const std::function<bool(std::uint32_t)>& counts) {
    std::vector<SolidElement>& list = elements.list;
    UnionFind joined(list.size());
    const std::vector<CubeNeighbors> neighbors = cubeNeighbors(list);
    for (std::uint32_t n = 0; n < list.size(); ++n)
        for (const CubeSide side : {x_high, y_high, z_high})
            if (neighbors[n][side] != kNoCube) joined.join(n, neighbors[n][side]);

    std::vector<std::uint32_t> size(list.size());
    std::vector<std::uint32_t> counted(list.size());
    Pieces pieces;
    bool any = false;
    for (std::uint32_t n = 0; n < list.size(); ++n) {
        const std::uint32_t piece = joined.find(n);
        if (size[piece]++ == 0) ++pieces.count;
        if (!counts || !counts(list[n].bead)) continue;
        ++counted[piece];
        any = true;
    }
    if (pieces.count < 2) return pieces;
    const std::vector<std::uint32_t>& by = any ? counted : size;
    const auto largest = static_cast<std::uint32_t>(std::max_element(by.begin(), by.end()) - by.begin());
    std::size_t kept = 0;
    for (std::uint32_t n = 0; n < list.size(); ++n)
        if (joined.find(n) == largest) list[kept++] = list[n];
    pieces.removed = list.size() - kept;
    list.resize(kept);
    return pieces;
}

}  // namespace stratum::mechanics
