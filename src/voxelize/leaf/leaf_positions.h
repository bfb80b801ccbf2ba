// The leaf positions that beads touch, as intervals along z, column by column, and the gaps between them.
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

/// Numbers the leaf positions that beads touch (slots) and the gaps between, below and above them. Immutable after
/// construction; shared by all threads.
class LeafPositions {
public:
    /// Leaves first..last along z, in leaves from index 0; `slot` is the slot of `first`, the others follow.
    struct Interval {
        int first, last;
        std::uint32_t slot;
        std::size_t slotOf(int k) const { return slot + static_cast<std::size_t>(k - first); }
    };
    /// The number of a slot, or that of a gap.
    struct SlotOrGap {
        bool is_slot;
        std::size_t index;
    };

    /// Of the beads below index `end`. Parallel.
    LeafPositions(const PlanBins& bins, const ColumnSource& columns, std::uint32_t end);

    std::size_t slotCount() const { return slot_count_; }
    std::size_t gapCount() const { return intervals_.size() + columns(); }
    std::size_t columns() const { return interval_offsets_.size() - 1; }

    /// Ascending and disjoint. Gap n of a column lies below its interval n; one more gap lies above the last interval.
    std::span<const Interval> intervalsOf(std::size_t column) const {
        return {intervals_.data() + interval_offsets_[column], intervals_.data() + interval_offsets_[column + 1]};
    }
    std::size_t firstGap(std::size_t column) const { return interval_offsets_[column] + column; }
    std::size_t gapCount(std::size_t column) const {
        return interval_offsets_[column + 1] - interval_offsets_[column] + 1;
    }
    SlotOrGap at(std::size_t column, int k) const;

private:
    std::size_t slot_count_ = 0;
    std::vector<std::size_t> interval_offsets_;
    std::vector<Interval> intervals_;
};

}  // namespace stratum::voxelize
