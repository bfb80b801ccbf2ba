// Leaf positions near a surface, as intervals along z, column by column, and the uniform gaps between them: what a
// flood walks through.
#pragma once

#include "voxelize/beads/plan_bins.h"
#include "voxelize/leaf/leaf_column.h"
#include "voxelize/leaf/leaf_mask.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace stratum::voxelize {

/// Numbers the leaf positions (slots), ascending in z within a column, and the gaps between, below and above them.
/// Where no column is, all is outside. Immutable after construction; shared by all threads.
class LeafPositions {
public:
    static constexpr std::size_t kNowhere = ~std::size_t{0};
    /// Leaves first..last along z, in leaves from index 0; `slot` is the slot of `first`, the others follow.
    struct Interval {
        int first, last;
        std::uint32_t slot;
        std::size_t slotOf(int k) const { return slot + static_cast<std::size_t>(k - first); }
    };
    /// A slot, or a gap; gap kNowhere where no column is.
    struct Place {
        bool leaf = false;
        std::size_t index = kNowhere;
    };

    LeafPositions() = default;
    /// `squares`: where the columns are, in columns from index 0, each once. `ranges`: the leaf positions of each,
    /// ascending and with gaps between.
    LeafPositions(std::span<const PlanIndex::Square> squares, std::span<const std::vector<LeafRange>> ranges);

    std::size_t slotCount() const { return slot_count_; }
    std::size_t gapCount() const { return intervals_.size() + columnCount(); }
    std::size_t columnCount() const { return index_.size(); }
    int columnI(std::size_t c) const { return index_.squares()[c].x; }
    int columnJ(std::size_t c) const { return index_.squares()[c].y; }
    /// The column of a place of the plan, or kNowhere.
    std::size_t columnAt(int i, int j) const {
        const std::uint32_t c = index_.find(i, j);
        return c == PlanIndex::kNone ? kNowhere : c;
    }

    /// Gap n of a column lies below its interval n; one more gap lies above the last interval.
    std::span<const Interval> intervalsOf(std::size_t c) const {
        return {intervals_.data() + interval_offsets_[c], intervals_.data() + interval_offsets_[c + 1]};
    }
    std::size_t firstGap(std::size_t c) const { return interval_offsets_[c] + c; }
    /// Leaf coordinates [low, high) of gap n of a column; of those at the ends, as far as kEnd.
    struct Range {
        int low, high;
    };
    static constexpr int kEnd = 1 << 28;
    Range gapRange(std::size_t c, std::size_t n) const;

    /// What is at leaf coordinate `k` of a column.
    Place at(std::size_t c, int k) const;
    /// The same of a place of the plan.
    Place at(int i, int j, int k) const {
        const std::size_t c = columnAt(i, j);
        return c != kNowhere ? at(c, k) : Place{};
    }

    /// The masks of leaf coordinate `k` of a column and around it: mask_of(slot) is a `const LeafMask*`, null for an
    /// empty one; gaps are full where gap_is_full(gap), and so is what is nowhere.
    template <typename MaskOf, typename GapIsFull>
    Neighbourhood around(std::size_t c, int k, const MaskOf& mask_of, const GapIsFull& gap_is_full) const {
        static const LeafMask kFull = LeafMask::full();
        Neighbourhood out{};
        for (int dx = -1; dx <= 1; ++dx)
            for (int dy = -1; dy <= 1; ++dy) {
                const std::size_t beside = dx == 0 && dy == 0 ? c : columnAt(columnI(c) + dx, columnJ(c) + dy);
                for (int dz = -1; dz <= 1; ++dz) {
                    const Place place = beside != kNowhere ? at(beside, k + dz) : Place{};
                    const LeafMask*& mask = out[neighbourIndex(dx, dy, dz)];
                    if (place.leaf)
                        mask = mask_of(place.index);
                    else if (place.index == kNowhere || gap_is_full(place.index))
                        mask = &kFull;
                }
            }
        return out;
    }

private:
    PlanIndex index_;  // of the columns
    std::size_t slot_count_ = 0;
    std::vector<std::size_t> interval_offsets_;
    std::vector<Interval> intervals_;
};

}  // namespace stratum::voxelize
