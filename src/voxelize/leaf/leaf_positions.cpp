#include "voxelize/leaf/leaf_positions.h"

#include <algorithm>

namespace stratum::voxelize {

LeafPositions::LeafPositions(std::span<const PlanIndex::Square> squares,
                             std::span<const std::vector<LeafRange>> ranges) {
    interval_offsets_.assign(squares.size() + 1, 0);
    for (std::size_t c = 0; c < squares.size(); ++c) {
        index_.add(squares[c].x, squares[c].y);
        for (const auto& [first, last] : ranges[c]) {
            intervals_.push_back({first, last, static_cast<std::uint32_t>(slot_count_)});
            slot_count_ += static_cast<std::size_t>(last - first) + 1;
        }
        interval_offsets_[c + 1] = intervals_.size();
    }
}

LeafPositions::Range LeafPositions::gapRange(std::size_t c, std::size_t n) const {
    const auto intervals = intervalsOf(c);
    return {n == 0 ? -kEnd : intervals[n - 1].last + 1, n == intervals.size() ? kEnd : intervals[n].first};
}

LeafPositions::Place LeafPositions::at(std::size_t c, int k) const {
    const auto intervals = intervalsOf(c);
    const auto above = std::partition_point(intervals.begin(), intervals.end(),
                                            [k](const Interval& interval) { return interval.last < k; });
    if (above != intervals.end() && above->first <= k) return {true, above->slotOf(k)};
    return {false, firstGap(c) + static_cast<std::size_t>(above - intervals.begin())};
}

}  // namespace stratum::voxelize
