// Where leaves can be: the runs of leaf positions that beads touch, column by column, and the air between them.
#pragma once

#include "voxelize/beads/plan_bins.h"
#include "voxelize/leaf/leaf_column.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace stratum::voxelize {

/// Gives each calling thread a LeafColumn of its own.
using ColumnSource = std::function<LeafColumn&()>;

/// Every leaf position that beads touch has a number, its slot; what lies between, below and above them is air, and has
/// numbers too. Immutable after construction: any thread may ask.
class LeafPlaces {
public:
    /// Leaves first..last along z; `slot` is that of `first`, the others follow.
    struct Run {
        int first, last;
        std::uint32_t slot;
        std::size_t slotOf(int k) const { return slot + static_cast<std::size_t>(k - first); }
    };
    /// A slot, or the number of an air.
    struct Place {
        bool slot;
        std::size_t index;
    };

    /// Of the beads below index `end`. Parallel.
    LeafPlaces(const PlanBins& bins, const ColumnSource& columns, std::uint32_t end);

    std::size_t slotCount() const { return slot_count_; }
    std::size_t airCount() const { return runs_.size() + columns(); }
    std::size_t columns() const { return run_offsets_.size() - 1; }

    /// Ascending, apart. Air n of a column lies below its run n, and one more lies above the last.
    std::span<const Run> runsOf(std::size_t column) const {
        return {runs_.data() + run_offsets_[column], runs_.data() + run_offsets_[column + 1]};
    }
    std::size_t firstAir(std::size_t column) const { return run_offsets_[column] + column; }
    std::size_t airCount(std::size_t column) const { return run_offsets_[column + 1] - run_offsets_[column] + 1; }
    Place at(std::size_t column, int k) const;

    bool inside(int i, int j) const { return i >= 0 && j >= 0 && i < columns_i_ && j < columns_j_; }
    std::size_t columnAt(int i, int j) const {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_i_) + static_cast<std::size_t>(i);
    }
    int columnI(std::size_t column) const { return static_cast<int>(column % static_cast<std::size_t>(columns_i_)); }
    int columnJ(std::size_t column) const { return static_cast<int>(column / static_cast<std::size_t>(columns_i_)); }

private:
    int columns_i_, columns_j_;
    std::size_t slot_count_ = 0;
    std::vector<std::size_t> run_offsets_;
    std::vector<Run> runs_;
};

}  // namespace stratum::voxelize
