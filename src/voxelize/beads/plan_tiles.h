// Squares of leaf columns in the plan, between heights: those that one of several processes makes.
#pragma once

#include "voxelize/beads/footprint.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace stratum::voxelize {

/// From the lowest to the highest point, mm; of nothing if the first is above the second.
struct HeightRange {
    double z_min = std::numeric_limits<double>::max();
    double z_max = std::numeric_limits<double>::lowest();
    bool meets(const HeightRange& other) const { return z_min <= other.z_max && other.z_min <= z_max; }
};

/// Some of the squares of kTileColumns x kTileColumns columns, from column 0, that a rectangle of columns meets.
class PlanTiles {
public:
    static constexpr int kTileColumns = 16;

    /// None of them. The rectangle is not empty.
    explicit PlanTiles(const ColumnRange& columns)
        : columns_(columns),
          first_x_(tileOf(columns.i0)),
          first_y_(tileOf(columns.j0)),
          count_y_(static_cast<std::size_t>(tileOf(columns.j1) - first_y_) + 1),
          chosen_(static_cast<std::size_t>(tileOf(columns.i1) - first_x_ + 1) * count_y_) {}

    /// All columns, not only those of chosen tiles.
    const ColumnRange& columns() const { return columns_; }

    /// Of a tile that is chosen again, all between its heights.
    void choose(int x, int y, const HeightRange& heights) {
        HeightRange& chosen = chosen_[placeOf(x, y)];
        chosen.z_min = std::min(chosen.z_min, heights.z_min);
        chosen.z_max = std::max(chosen.z_max, heights.z_max);
    }
    /// Whether something of these heights concerns a tile.
    bool has(int x, int y, const HeightRange& heights) const { return chosen_[placeOf(x, y)].meets(heights); }

    /// Whether a rectangle within columns() has a column of such a tile.
    bool meet(const ColumnRange& some, const HeightRange& heights) const {
        for (int x = tileOf(some.i0); x <= tileOf(some.i1); ++x)
            for (int y = tileOf(some.j0); y <= tileOf(some.j1); ++y)
                if (has(x, y, heights)) return true;
        return false;
    }

    /// Calls visit(i0, i1, j) for those of the columns [i0, i1] of row j that lie in such tiles.
    template <typename Visit>
    void forEachIn(int i0, int i1, int j, const HeightRange& heights, const Visit& visit) const {
        const int y = tileOf(j);
        for (int x = tileOf(i0); x <= tileOf(i1); ++x)
            if (has(x, y, heights)) visit(std::max(i0, x * kTileColumns), std::min(i1, (x + 1) * kTileColumns - 1), j);
    }

    static int tileOf(int column) { return column / kTileColumns - (column % kTileColumns < 0 ? 1 : 0); }

private:
    std::size_t placeOf(int x, int y) const {
        return static_cast<std::size_t>(x - first_x_) * count_y_ + static_cast<std::size_t>(y - first_y_);
    }

    ColumnRange columns_;
    int first_x_, first_y_;
    std::size_t count_y_;
    std::vector<HeightRange> chosen_;
};

}  // namespace stratum::voxelize
