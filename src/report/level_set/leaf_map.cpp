#include "report/level_set/leaf_map.h"

#include "base/parallel_for.h"

#include <tbb/parallel_sort.h>

#include <cstring>
#include <tuple>
#include <utility>

namespace stratum::report {
namespace {

constexpr std::size_t kColumnGrain = 256;

}  // namespace

LeafMap::LeafMap(const openvdb::FloatGrid& grid) {
    std::vector<std::pair<voxelize::PlanIndex::Square, const Leaf*>> leaves;
    leaves.reserve(grid.tree().leafCount());
    for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf)
        leaves.push_back({{leaf->origin().x() >> 3, leaf->origin().y() >> 3}, leaf.getLeaf()});
    tbb::parallel_sort(leaves.begin(), leaves.end(), [](const auto& a, const auto& b) {
        return std::tuple(a.first.y, a.first.x, a.second->origin().z()) <
               std::tuple(b.first.y, b.first.x, b.second->origin().z());
    });
    std::vector<voxelize::PlanIndex::Square> squares;
    std::vector<std::vector<voxelize::LeafRange>> ranges;
    for (const auto& [square, leaf] : leaves) {
        if (squares.empty() || !(squares.back() == square)) {
            squares.push_back(square);
            ranges.emplace_back();
        }
        const int k = leaf->origin().z() >> 3;
        std::vector<voxelize::LeafRange>& column = ranges.back();
        if (!column.empty() && column.back().second == k - 1)
            column.back().second = k;
        else
            column.emplace_back(k, k);
        leaves_.push_back(leaf);
        k_.push_back(k);
        column_of_.push_back(static_cast<std::uint32_t>(squares.size() - 1));
    }
    positions_ = voxelize::LeafPositions(squares, ranges);
    gap_inside_.assign(positions_.gapCount(), 0);
    parallelFor(squares.size(), kColumnGrain, [&](std::size_t begin, std::size_t end) {
        const openvdb::tree::ValueAccessor<const openvdb::FloatTree> tree(grid.tree());
        for (std::size_t c = begin; c != end; ++c)
            for (std::size_t n = 1; n < positions_.intervalsOf(c).size(); ++n) {
                const openvdb::Coord voxel(squares[c].x * 8, squares[c].y * 8, positions_.gapRange(c, n).low * 8);
                gap_inside_[positions_.firstGap(c) + n] = tree.getValue(voxel) < 0 ? 1 : 0;
            }
    });
}

LeafMap::CellPlaces LeafMap::cellPlaces(std::size_t n) const {
    CellPlaces places;
    const std::size_t c = columnOf(n);
    const int k = leafK(n);
    const int own_i = positions_.columnI(c);
    const int own_j = positions_.columnJ(c);
    for (std::size_t corner = 0; corner < 4; ++corner) {
        const int i = own_i + static_cast<int>(corner & 1U);
        const int j = own_j + static_cast<int>(corner >> 1);
        const Place here = corner == 0 ? Place{true, n} : positions_.at(i, j, k);
        places[corner] = here;
        // Mostly the next leaf of that column.
        const bool next = here.leaf && here.index + 1 < leafCount() &&
                          columnOf(here.index + 1) == columnOf(here.index) && leafK(here.index + 1) == k + 1;
        places[corner + 4] = next ? Place{true, here.index + 1} : positions_.at(i, j, k + 1);
    }
    return places;
}

void LeafMap::gather(const CellPlaces& places, float (&samples)[9][9][9], float outside) const {
    const float* values = leaf(places[0].index).buffer().data();
    for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 8; ++y, values += 8) std::memcpy(samples[x][y], values, 8 * sizeof(float));
    for (int corner = 1; corner < 8; ++corner) {
        const int dx = corner & 1;
        const int dy = corner >> 1 & 1;
        const int dz = corner >> 2;
        const Place& place = places[static_cast<std::size_t>(corner)];
        const float* next = place.leaf ? leaf(place.index).buffer().data() : nullptr;
        const float all = place.leaf || place.index == kNowhere || !gapInside(place.index) ? outside : -outside;
        for (int x = 0; x < (dx != 0 ? 1 : 8); ++x)
            for (int y = 0; y < (dy != 0 ? 1 : 8); ++y)
                for (int z = 0; z < (dz != 0 ? 1 : 8); ++z)
                    samples[x + 8 * dx][y + 8 * dy][z + 8 * dz] = next != nullptr ? next[(x * 8 + y) * 8 + z] : all;
    }
}

}  // namespace stratum::report
