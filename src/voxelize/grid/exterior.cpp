#include "voxelize/grid/exterior.h"

#include "base/parallel_for.h"
#include "base/stopwatch.h"
#include "voxelize/leaf/leaf_flood.h"
#include "voxelize/leaf/leaf_positions.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <memory>
#include <utility>

namespace stratum::voxelize {
namespace {

using Clock = std::chrono::steady_clock;
using Interval = LeafPositions::Interval;

constexpr std::size_t kGrain = 8;  // columns
constexpr std::uint32_t kUnknown = 0xffffffff;

LeafPositions touchedPositions(const PrintColumns& columns, std::uint32_t end) {
    std::vector<std::vector<LeafRange>> ranges(columns.size());
    columns.forEach(end, [&](std::size_t c, LeafColumn& column) {
        const auto touched = column.touched();
        ranges[c].assign(touched.begin(), touched.end());
    });
    return {columns.bins().places(), ranges};
}

class Exterior {
public:
    // `whole`: a grid of all leaves in which they are looked up; null to evaluate them.
    Exterior(const PrintColumns& columns, std::uint32_t end, const ExteriorRule& rule, const openvdb::FloatTree* whole)
        : columns_(columns),
          end_(end),
          rule_(rule),
          whole_(whole),
          positions_(touchedPositions(columns, end)),
          passable_([this](std::size_t c, int k, std::size_t slot) {
              find(c, k, slot);
              return maskOf(c, k, slot, rule_.clearance);
          }),
          flood_(positions_, passable_),
          content_(positions_.slotCount(), Content::unknown),
          leaves_(whole == nullptr ? positions_.slotCount() : 0) {}

    ExteriorCounts run(LeavesByColumn& leaves, const std::function<void(double)>& progress) {
        ExteriorCounts counts;
        counts.positions = positions_.slotCount();
        counts.rounds = flood_.run(progress);
        markNear();
        findMissing();
        findShown();
        collect(leaves, counts);
        counts.evaluate_seconds = evaluate_seconds_;
        if (progress) progress(1);
        return counts;
    }

private:
    enum class Content : std::uint8_t { unknown, outside, inside, surface };

    // Evaluates or looks up a leaf position; for one column from one thread at a time.
    void find(std::size_t c, int k, std::size_t slot) {
        const auto start = Clock::now();
        LeafContent content = LeafContent::surface;
        if (whole_ != nullptr) {
            const openvdb::Coord origin = originOf(c, k);
            if (whole_->probeConstLeaf(origin) == nullptr)
                content = whole_->getValue(origin) < 0 ? LeafContent::inside : LeafContent::outside;
        } else {
            const LeafColumn& column = columns_.evaluate(c, k, end_, content);
            if (content == LeafContent::surface) leaves_[slot] = column.makeLeaf();
        }
        content_[slot] = content == LeafContent::surface  ? Content::surface
                         : content == LeafContent::inside ? Content::inside
                                                          : Content::outside;
        evaluate_seconds_.fetch_add(secondsSince(start), std::memory_order_relaxed);
    }

    openvdb::Coord originOf(std::size_t c, int k) const {
        return {positions_.columnI(c) * kLeafDim, positions_.columnJ(c) * kLeafDim, k * kLeafDim};
    }
    const Leaf* leafAt(std::size_t c, int k, std::size_t slot) const {
        return whole_ != nullptr ? whole_->probeConstLeaf(originOf(c, k)) : leaves_[slot].get();
    }
    // The samples of a known position with phi of at least `least`.
    LeafMask maskOf(std::size_t c, int k, std::size_t slot, float least) const {
        LeafMask mask;
        if (content_[slot] == Content::outside) mask = LeafMask::full();
        if (content_[slot] == Content::surface) maskFrom(leafAt(c, k, slot)->buffer().data(), least, mask.word.data());
        return mask;
    }

    // Calls body(c, k, slot) for the positions for which keep(slot), on all threads.
    template <typename Keep, typename Body>
    void forEach(const Keep& keep, const Body& body) const {
        parallelFor(positions_.columnCount(), kGrain, [&](std::size_t first, std::size_t last) {
            for (std::size_t c = first; c != last; ++c)
                for (const Interval& interval : positions_.intervalsOf(c))
                    for (int k = interval.first; k <= interval.last; ++k)
                        if (const std::size_t slot = interval.slotOf(k); keep(slot)) body(c, k, slot);
        });
    }
    template <typename Body>
    void forEachNear(const Body& body) const {
        forEach([this](std::size_t slot) { return near_[slot] != 0; }, body);
    }
    template <typename MaskOf>
    Neighbourhood around(std::size_t c, int k, const MaskOf& mask_of) const {
        return positions_.around(c, k, mask_of, [this](std::size_t gap) { return flood_.reachedGap(gap); });
    }
    Neighbourhood masksAround(std::size_t c, int k, const std::vector<LeafMask>& masks) const {
        return around(c, k,
                      [&](std::size_t slot) { return known_[slot] != kUnknown ? &masks[known_[slot]] : nullptr; });
    }
    Neighbourhood reachedAround(std::size_t c, int k) const {
        return around(c, k, [this](std::size_t slot) { return flood_.reached(slot); });
    }

    // The positions that were reached, or are beside one: the others concern nobody.
    void markNear() {
        near_.assign(positions_.slotCount(), 0);
        parallelFor(positions_.columnCount(), kGrain, [&](std::size_t first, std::size_t last) {
            for (std::size_t c = first; c != last; ++c)
                for (int n = 0; n < 9; ++n)
                    markNear(c,
                             positions_.columnAt(positions_.columnI(c) + n / 3 - 1, positions_.columnJ(c) + n % 3 - 1));
        });
    }
    void markNear(std::size_t c, std::size_t beside) {
        if (beside == LeafPositions::kNowhere) {
            markNear(c, -LeafPositions::kEnd, LeafPositions::kEnd);
            return;
        }
        const auto intervals = positions_.intervalsOf(beside);
        for (std::size_t n = 0; n <= intervals.size(); ++n) {
            const auto [low, high] = positions_.gapRange(beside, n);
            if (flood_.reachedGap(positions_.firstGap(beside) + n)) markNear(c, low - 1, high + 1);
        }
        for (const Interval& interval : intervals)
            for (int k = interval.first; k <= interval.last; ++k)
                if (const LeafMask* reached = flood_.reached(interval.slotOf(k));
                    reached != nullptr && !reached->empty())
                    markNear(c, k - 1, k + 2);
    }
    void markNear(std::size_t c, int low, int high) {
        for (const Interval& interval : positions_.intervalsOf(c))
            for (int k = std::max(interval.first, low); k < std::min(interval.last + 1, high); ++k)
                near_[interval.slotOf(k)] = 1;
    }

    // Openings that are too narrow for the flood can lead into leaves that it did not ask for.
    void findMissing() {
        forEachNear([this](std::size_t c, int k, std::size_t slot) {
            if (content_[slot] == Content::unknown && anyWithin(reachedAround(c, k), rule_.depth)) find(c, k, slot);
        });
        known_.assign(positions_.slotCount(), kUnknown);
        std::uint32_t count = 0;
        for (std::size_t slot = 0; slot < known_.size(); ++slot)
            if (content_[slot] != Content::unknown) known_[slot] = count++;
        outside_.resize(count);
        shown_.resize(count);
    }

    // Samples outside that are shown: those reached and those up to ExteriorRule::depth around them.
    void findShown() {
        const auto known = [this](std::size_t slot) { return known_[slot] != kUnknown; };
        forEach(known,
                [this](std::size_t c, int k, std::size_t slot) { outside_[known_[slot]] = maskOf(c, k, slot, 0); });
        forEach(known, [this](std::size_t c, int k, std::size_t slot) {
            shown_[known_[slot]] = spreadThrough(masksAround(c, k, outside_), reachedAround(c, k), rule_.depth);
        });
    }

    // Keeps the voxels within the band around shown ones, and turns the others inside.
    void collect(LeavesByColumn& leaves, ExteriorCounts& counts) {
        std::atomic<std::size_t> kept{0};
        std::atomic<std::size_t> kept_voxels{0};
        std::atomic<std::size_t> evaluated{0};
        forEachNear([&](std::size_t c, int k, std::size_t slot) {
            const bool known = known_[slot] != kUnknown;
            if (known && content_[slot] != Content::surface) return;
            const Neighbourhood shown = masksAround(c, k, shown_);
            if (!known && !anyWithin(shown, static_cast<int>(rule_.band))) return;
            const LeafMask near = dilateBall(shown, rule_.band);
            if (near.empty()) return;
            if (!known) {
                find(c, k, slot);
                evaluated.fetch_add(1, std::memory_order_relaxed);
                if (content_[slot] != Content::surface) return;
            }
            // Dropped: samples outside that are not shown, and samples inside that are far from shown ones.
            const LeafMask outside = known ? outside_[known_[slot]] : maskOf(c, k, slot, 0);
            const LeafMask visible = known ? shown_[known_[slot]] : LeafMask{};
            LeafMask drop;
            for (std::size_t x = 0; x < 8; ++x)
                drop.word[x] = (outside.word[x] & ~visible.word[x]) | (~outside.word[x] & ~near.word[x]);
            // Meshers look at sign changes beside active samples alone. The outside of a shown sample is inactive
            // farther away than the band, so that dropped ones beside it stay active.
            const LeafMask beside = dilateBall(shown, 1);
            LeafMask edge;
            for (std::size_t x = 0; x < 8; ++x) edge.word[x] = beside.word[x] & outside.word[x] & ~visible.word[x];
            for (std::size_t x = 0; x < 8; ++x) drop.word[x] &= ~edge.word[x];
            const std::size_t active = activeWithout(*leafAt(c, k, slot), drop, edge);
            if (active == 0) return;
            kept.fetch_add(1, std::memory_order_relaxed);
            kept_voxels.fetch_add(active, std::memory_order_relaxed);
            if (whole_ != nullptr) return;
            turnInside(*leaves_[slot], drop, false);
            turnInside(*leaves_[slot], edge, true);
            leaves[c].push_back(std::move(leaves_[slot]));
        });
        counts.kept = kept;
        counts.kept_voxels = kept_voxels;
        counts.evaluated = shown_.size() + evaluated;
    }

    static std::size_t activeWithout(const Leaf& leaf, const LeafMask& drop, const LeafMask& edge) {
        std::size_t count = 0;
        for (openvdb::Index x = 0; x < 8; ++x)
            count += static_cast<std::size_t>(
                std::popcount((leaf.getValueMask().getWord<openvdb::Index64>(x) & ~drop.word[x]) | edge.word[x]));
        return count;
    }

    void turnInside(Leaf& leaf, const LeafMask& drop, bool active) const {
        float* values = leaf.buffer().data();
        for (openvdb::Index x = 0; x < 8; ++x) {
            for (std::uint64_t bits = drop.word[x]; bits != 0; bits &= bits - 1)
                values[x * 64 + static_cast<openvdb::Index>(std::countr_zero(bits))] = -rule_.background;
            auto& mask = leaf.getValueMask().getWord<openvdb::Index64>(x);
            mask = active ? mask | drop.word[x] : mask & ~drop.word[x];
        }
    }

    const PrintColumns& columns_;
    const std::uint32_t end_;
    const ExteriorRule rule_;
    const openvdb::FloatTree* const whole_;
    const LeafPositions positions_;
    const LeafFlood::Passable passable_;
    LeafFlood flood_;
    // By slot.
    std::vector<Content> content_;
    std::vector<std::unique_ptr<Leaf>> leaves_;  // that were made
    std::vector<std::uint8_t> near_;
    std::vector<std::uint32_t> known_;  // index into the masks
    std::vector<LeafMask> outside_;     // samples with phi >= 0
    std::vector<LeafMask> shown_;
    std::atomic<double> evaluate_seconds_{0};
};

}  // namespace

ExteriorCounts buildReachable(const PrintColumns& columns, std::uint32_t end, const ExteriorRule& rule,
                              LeavesByColumn& leaves, const std::function<void(double)>& progress) {
    leaves.clear();
    leaves.resize(columns.size());
    return Exterior(columns, end, rule, nullptr).run(leaves, progress);
}

ExteriorCounts countReachable(const PrintColumns& columns, std::uint32_t end, const ExteriorRule& rule,
                              const openvdb::FloatTree& whole) {
    LeavesByColumn none;
    return Exterior(columns, end, rule, &whole).run(none, {});
}

}  // namespace stratum::voxelize
