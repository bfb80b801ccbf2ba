#include "voxelize/leaf/leaf_positions.h"

#include "base/parallel_for.h"

namespace stratum::voxelize {

LeafPositions::LeafPositions(const PlanBins& bins, const ColumnSource& columns, std::uint32_t end) {
    constexpr std::size_t kColumnGrain = 8;
    std::vector<std::vector<LeafRange>> ranges(bins.size());
    parallelFor(bins.size(), kColumnGrain, [&](std::size_t first, std::size_t last) {
        LeafColumn& column = columns();
        for (std::size_t c = first; c != last; ++c) {
            column.open(bins.originI(c), bins.originJ(c), bins[c], end);
            const auto touched = column.touched();
            ranges[c].assign(touched.begin(), touched.end());
        }
    });
    interval_offsets_.assign(bins.size() + 1, 0);
    for (std::size_t c = 0; c < bins.size(); ++c) {
        for (const auto& [first, last] : ranges[c]) {
            intervals_.push_back({first, last, static_cast<std::uint32_t>(slot_count_)});
            slot_count_ += static_cast<std::size_t>(last - first) + 1;
        }
        interval_offsets_[c + 1] = intervals_.size();
    }
}

LeafPositions::SlotOrGap LeafPositions::at(std::size_t column, int k) const {
    const auto intervals = intervalsOf(column);
    std::size_t n = 0;
    while (n < intervals.size() && intervals[n].last < k) ++n;
    if (n < intervals.size() && intervals[n].first <= k) return {true, intervals[n].slotOf(k)};
    return {false, firstGap(column) + n};
}

}  // namespace stratum::voxelize
