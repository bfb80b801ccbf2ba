#include "report/level_set/leaf_map.h"

#include "base/parallel_for.h"

#include <algorithm>
#include <cstring>
#include <tuple>

namespace stratum::report {
namespace {

constexpr std::size_t kColumnGrain = 256;

}  // namespace

LeafMap::LeafMap(const openvdb::FloatGrid& grid) {
    std::vector<const Leaf*> unordered;
    unordered.reserve(grid.tree().leafCount());
    voxelize::PlanIndex unordered_columns;
    for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
        unordered_columns.add(leaf->origin().x() >> 3, leaf->origin().y() >> 3);
        unordered.push_back(leaf.getLeaf());
    }
    if (unordered.empty()) {
        first_.assign(1, 0);
        return;
    }
    std::vector<voxelize::PlanIndex::Square> squares = unordered_columns.squares();
    std::sort(squares.begin(), squares.end(),
              [](const auto& a, const auto& b) { return std::tie(a.y, a.x) < std::tie(b.y, b.x); });
    for (const auto& square : squares) index_.add(square.x, square.y);
    first_.assign(squares.size() + 1, 0);
    const auto column = [this](const Leaf& leaf) { return columnAt(leaf.origin().x() >> 3, leaf.origin().y() >> 3); };
    for (const Leaf* leaf : unordered) ++first_[column(*leaf) + 1];
    for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
    leaves_.resize(unordered.size());
    column_of_.resize(unordered.size());
    k_.resize(unordered.size());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (const Leaf* leaf : unordered) leaves_[next[column(*leaf)]++] = leaf;
    gap_inside_.assign(leaves_.size() + columnCount(), 0);
    parallelFor(columnCount(), kColumnGrain, [&](std::size_t begin, std::size_t end) {
        const openvdb::tree::ValueAccessor<const openvdb::FloatTree> tree(grid.tree());
        for (std::size_t c = begin; c != end; ++c) {
            const std::size_t count = first_[c + 1] - first_[c];
            const auto from = leaves_.begin() + static_cast<std::ptrdiff_t>(first_[c]);
            std::sort(from, from + static_cast<std::ptrdiff_t>(count),
                      [](const Leaf* a, const Leaf* b) { return a->origin().z() < b->origin().z(); });
            for (std::size_t n = 0; n < count; ++n) {
                column_of_[first_[c] + n] = static_cast<std::uint32_t>(c);
                k_[first_[c] + n] = leaves_[first_[c] + n]->origin().z() >> 3;
            }
            for (std::size_t n = 1; n < count; ++n) {
                const Range range = gapRange(c, n);
                if (range.low == range.high) continue;
                const openvdb::Coord voxel(columnI(c) * 8, columnJ(c) * 8, range.low * 8);
                gap_inside_[firstGap(c) + n] = tree.getValue(voxel) < 0 ? 1 : 0;
            }
        }
    });
}

LeafMap::Range LeafMap::gapRange(std::size_t c, std::size_t n) const {
    const std::size_t count = first_[c + 1] - first_[c];
    return {n == 0 ? -kEnd : leafK(first_[c] + n - 1) + 1, n == count ? kEnd : leafK(first_[c] + n)};
}

LeafMap::Place LeafMap::at(std::size_t c, int k) const {
    const auto begin = k_.begin() + static_cast<std::ptrdiff_t>(first_[c]);
    const auto end = k_.begin() + static_cast<std::ptrdiff_t>(first_[c + 1]);
    const auto found = std::lower_bound(begin, end, k);
    const auto n = static_cast<std::size_t>(found - k_.begin());
    if (found != end && *found == k) return {true, n};
    return {false, firstGap(c) + (n - first_[c])};
}

LeafMap::CellPlaces LeafMap::cellPlaces(std::size_t n) const {
    CellPlaces places;
    const std::size_t c = columnOf(n);
    const int k = leafK(n);
    for (std::size_t corner = 0; corner < 4; ++corner) {
        const int i = columnI(c) + static_cast<int>(corner & 1U);
        const int j = columnJ(c) + static_cast<int>(corner >> 1);
        const Place here = corner == 0 ? Place{true, n} : at(i, j, k);
        places[corner] = here;
        // Mostly the next leaf of that column.
        const bool next = here.leaf && here.index + 1 < leafCount() &&
                          columnOf(here.index + 1) == columnOf(here.index) && leafK(here.index + 1) == k + 1;
        places[corner + 4] = next ? Place{true, here.index + 1} : at(i, j, k + 1);
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
