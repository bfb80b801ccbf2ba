#include "voxelize/grid/exterior.h"

#include "base/parallel_for.h"
#include "base/stopwatch.h"
#include "voxelize/leaf/leaf_mask.h"
#include "voxelize/leaf/leaf_positions.h"

#include <tbb/concurrent_vector.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

namespace stratum::voxelize {
namespace {

using Clock = std::chrono::steady_clock;

// A leaf position that the flood has reached. Only the thread that works on its column writes; other threads read the
// words of `reached` meanwhile. Bits are only ever set, and the thread that sets a bit queues the neighbours that it
// concerns, so a bit that a reader misses is seen in the next round. For that, queueing is a release operation, and
// taking from the queue an acquire operation.
struct Cell {
    std::unique_ptr<Leaf> leaf;  // null if leaves are only looked up, or if all samples are outside or inside
    bool surface = false;
    LeafMask passable;  // samples that the flood may take
    LeafMask outside;   // samples with phi >= 0
    LeafMask settled;   // a copy of `reached` after the flood
    LeafMask shown;     // samples outside that are shown: those reached and those up to ExteriorRule::depth around them
    std::array<std::atomic<std::uint64_t>, 8> reached{};

    LeafMask load() const {
        LeafMask mask;
        for (std::size_t x = 0; x < 8; ++x) mask.word[x] = reached[x].load(std::memory_order_relaxed);
        return mask;
    }
    void store(const LeafMask& mask) {
        for (std::size_t x = 0; x < 8; ++x) reached[x].store(mask.word[x], std::memory_order_relaxed);
    }
};

constexpr std::uint32_t kUnvisited = 0xffffffff;
constexpr std::size_t kFloodGrain = 8;

constexpr int kFaces[6][3] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};

// Whether a mask has bits on that face of its leaf.
bool touchesFace(const LeafMask& mask, const int (&face)[3]) {
    if (face[0] != 0) return mask.word[face[0] < 0 ? 0 : 7] != 0;
    std::uint64_t any = 0;
    for (const std::uint64_t word : mask.word) any |= word;
    if (face[1] != 0) return (any & (face[1] < 0 ? 0xffU : std::uint64_t{0xff} << 56)) != 0;
    return (any & (face[2] < 0 ? 0x0101010101010101U : 0x8080808080808080U)) != 0;
}

class Flood {
public:
    // `whole`: a grid of all leaves in which they are looked up; null to evaluate them.
    Flood(const PlanBins& bins, const ColumnSource& columns, std::uint32_t end, const ExteriorRule& rule,
          const openvdb::FloatTree* whole)
        : bins_(bins), columns_(columns), end_(end), rule_(rule), whole_(whole), positions_(bins, columns, end) {}

    ExteriorCounts run(LeavesByColumn& leaves, const std::function<void(double)>& progress) {
        begin();
        floodGaps();
        while (anyQueued()) {
            ++counts_.rounds;
            spread();
            floodGaps();
            if (progress) progress(static_cast<double>(cells_.size()) / static_cast<double>(positions_.slotCount()));
        }
        findShown();
        collect(leaves);
        if (progress) progress(1);
        counts_.evaluate_seconds = evaluate_seconds_.load();
        counts_.flood_seconds = thread_seconds_.load() - counts_.evaluate_seconds;
        return counts_;
    }

private:
    using Interval = LeafPositions::Interval;
    using SlotOrGap = LeafPositions::SlotOrGap;

    void begin() {
        const auto start = Clock::now();
        const std::size_t slots = positions_.slotCount();
        counts_.positions = slots;
        cells_of_ = std::vector<std::atomic<std::uint32_t>>(slots);
        for (auto& cell : cells_of_) cell.store(kUnvisited, std::memory_order_relaxed);
        queued_ = std::vector<std::atomic<std::uint8_t>>(slots);
        near_ = std::vector<std::atomic<std::uint8_t>>(slots);
        dirty_ = std::vector<std::atomic<std::uint8_t>>(bins_.size());
        gap_reached_ = std::vector<std::atomic<std::uint8_t>>(positions_.gapCount());
        // Places without a column are reached from the start, and so are the gaps below and above every column.
        for (std::size_t c = 0; c < bins_.size(); ++c) {
            const std::size_t gaps = positions_.gapCount(c);
            reachGap(c, 0);
            reachGap(c, gaps - 1);
            bool free_face = false;
            bool free_side = false;
            for (int n = 0; n < 9; ++n) {
                if (columnBeside(c, n / 3 - 1, n % 3 - 1) != PlanBins::kNone) continue;
                free_side = true;
                free_face = free_face || n % 2 == 1;
            }
            if (free_face)
                for (std::size_t n = 1; n + 1 < gaps; ++n) reachGap(c, n);
            if (!free_side) continue;
            for (const Interval& interval : positions_.intervalsOf(c))
                for (int k = interval.first; k <= interval.last; ++k) queue(c, interval.slotOf(k));
        }
        addThreadSeconds(secondsSince(start));
    }

    std::size_t columnBeside(std::size_t c, int dx, int dy) const {
        return bins_.find(bins_.columnI(c) + dx, bins_.columnJ(c) + dy);
    }

    void reachGap(std::size_t c, std::size_t n) {
        if (gap_reached_[positions_.firstGap(c) + n].exchange(1, std::memory_order_relaxed) == 0)
            new_gaps_.push_back({c, n});
    }

    void queue(std::size_t c, std::size_t slot) {
        near_[slot].store(1, std::memory_order_relaxed);
        // Exchanges, not stores: two threads may queue one leaf, and the thread that takes it must see the writes of
        // both. A store would break the release sequence of the first.
        queued_[slot].exchange(1, std::memory_order_release);
        dirty_[c].exchange(1, std::memory_order_release);
    }

    bool anyQueued() const {
        return std::any_of(dirty_.begin(), dirty_.end(),
                           [](const auto& flag) { return flag.load(std::memory_order_relaxed) != 0; });
    }

    // Spreads from reached gaps to the gaps beside them, and queues the leaves that they touch.
    void floodGaps() {
        const auto start = Clock::now();
        new_gaps_.insert(new_gaps_.end(), found_gaps_.begin(), found_gaps_.end());
        found_gaps_.clear();
        while (!new_gaps_.empty()) {
            const auto [c, n] = new_gaps_.back();
            new_gaps_.pop_back();
            const auto intervals = positions_.intervalsOf(c);
            const int low = n > 0 ? intervals[n - 1].last + 1 : std::numeric_limits<int>::min() + 1;
            const int high = n < intervals.size() ? intervals[n].first - 1 : std::numeric_limits<int>::max() - 1;
            if (n > 0) queue(c, intervals[n - 1].slotOf(intervals[n - 1].last));
            if (n < intervals.size()) queue(c, intervals[n].slot);
            for (int dx = -1; dx <= 1; ++dx)
                for (int dy = -1; dy <= 1; ++dy) {
                    if (dx == 0 && dy == 0) continue;
                    const std::size_t beside = columnBeside(c, dx, dy);
                    if (beside == PlanBins::kNone) continue;
                    const auto other = positions_.intervalsOf(beside);
                    for (const Interval& interval : other)
                        for (int k = std::max(interval.first, low - 1); k <= std::min(interval.last, high + 1); ++k)
                            queue(beside, interval.slotOf(k));
                    if (dx != 0 && dy != 0) continue;
                    for (std::size_t m = 0; m <= other.size(); ++m) {
                        const int from = m > 0 ? other[m - 1].last + 1 : std::numeric_limits<int>::min() + 1;
                        const int to = m < other.size() ? other[m].first - 1 : std::numeric_limits<int>::max() - 1;
                        if (std::max(from, low) <= std::min(to, high)) reachGap(beside, m);
                    }
                }
        }
        addThreadSeconds(secondsSince(start));
    }

    // Of a column, or of a place without one.
    const LeafMask* reachedAt(std::size_t c, int k, LeafMask& storage) const {
        static const LeafMask kAll = LeafMask::full();
        if (c == PlanBins::kNone) return &kAll;
        const SlotOrGap at = positions_.at(c, k);
        if (!at.is_slot) return gap_reached_[at.index].load(std::memory_order_relaxed) != 0 ? &kAll : nullptr;
        const std::uint32_t cell = cells_of_[at.index].load(std::memory_order_acquire);
        if (cell == kUnvisited) return nullptr;
        storage = cells_[cell].load();
        return storage.empty() ? nullptr : &storage;
    }

    LeafMask seedsOf(std::size_t c, int k) const {
        LeafMask storage[7];
        Neighbourhood around{};
        around[neighbourIndex(0, 0, 0)] = reachedAt(c, k, storage[6]);
        for (std::size_t n = 0; n < 6; ++n) {
            const auto [dx, dy, dz] = kFaces[n];
            const std::size_t beside = dz != 0 ? c : columnBeside(c, dx, dy);
            around[neighbourIndex(dx, dy, dz)] = reachedAt(beside, k + dz, storage[n]);
        }
        return dilateFaces(around);
    }

    // A leaf position after the flood: a reached gap, a cell, or neither.
    struct Known {
        bool reached_gap = false;
        const Cell* cell = nullptr;
    };
    using Around = std::array<Known, 27>;

    Around around(std::size_t c, int k) const {
        Around known{};
        for (int dx = -1; dx <= 1; ++dx)
            for (int dy = -1; dy <= 1; ++dy) {
                const std::size_t beside = columnBeside(c, dx, dy);
                for (int dz = -1; dz <= 1; ++dz) {
                    Known& out = known[neighbourIndex(dx, dy, dz)];
                    if (beside == PlanBins::kNone) {
                        out.reached_gap = true;
                        continue;
                    }
                    const SlotOrGap at = positions_.at(beside, k + dz);
                    if (!at.is_slot) {
                        out.reached_gap = gap_reached_[at.index].load(std::memory_order_relaxed) != 0;
                    } else if (const std::uint32_t cell = cells_of_[at.index].load(std::memory_order_acquire);
                               cell != kUnvisited) {
                        out.cell = &cells_[cell];
                    }
                }
            }
        return known;
    }

    static Neighbourhood masksOf(const Around& around, LeafMask Cell::*mask) {
        static const LeafMask kAll = LeafMask::full();
        Neighbourhood out{};
        for (std::size_t n = 0; n < out.size(); ++n)
            out[n] = around[n].reached_gap ? &kAll : around[n].cell != nullptr ? &(around[n].cell->*mask) : nullptr;
        return out;
    }

    Cell& cellAt(LeafColumn& column, bool& opened, std::size_t c, int k, std::size_t slot, double& evaluating) {
        const std::uint32_t known = cells_of_[slot].load(std::memory_order_relaxed);
        if (known != kUnvisited) return cells_[known];
        const auto start = Clock::now();
        const auto it = cells_.emplace_back();
        Cell& cell = *it;
        LeafContent content = LeafContent::surface;
        const Leaf* leaf = nullptr;
        if (whole_ != nullptr) {
            const openvdb::Coord origin(bins_.originI(c), bins_.originJ(c), k * kLeafDim);
            leaf = whole_->probeConstLeaf(origin);
            if (leaf == nullptr) content = whole_->getValue(origin) < 0 ? LeafContent::inside : LeafContent::outside;
        } else {
            if (!opened) column.open(bins_.originI(c), bins_.originJ(c), bins_[c], end_);
            opened = true;
            content = column.evaluate(k);
            if (content == LeafContent::surface) cell.leaf = column.makeLeaf();
            leaf = cell.leaf.get();
        }
        cell.surface = leaf != nullptr;
        if (content == LeafContent::outside) cell.passable = cell.outside = LeafMask::full();
        if (leaf != nullptr) {
            maskFrom(leaf->buffer().data(), rule_.clearance, cell.passable.word.data());
            maskFrom(leaf->buffer().data(), 0, cell.outside.word.data());
        }
        cells_of_[slot].store(static_cast<std::uint32_t>(it - cells_.begin()), std::memory_order_release);
        evaluating += secondsSince(start);
        return cell;
    }

    // Marks the leaves around a reached one: they are examined after the flood.
    void markNear(std::size_t c, int k) {
        for (int dx = -1; dx <= 1; ++dx)
            for (int dy = -1; dy <= 1; ++dy) {
                const std::size_t beside = columnBeside(c, dx, dy);
                if (beside == PlanBins::kNone) continue;
                for (int dz = -1; dz <= 1; ++dz) {
                    const SlotOrGap at = positions_.at(beside, k + dz);
                    if (at.is_slot) near_[at.index].store(1, std::memory_order_relaxed);
                }
            }
    }

    // One round: the flood enters every queued leaf from its neighbours.
    void spread() {
        parallelFor(bins_.size(), kFloodGrain, [&](std::size_t first, std::size_t last) {
            const auto start = Clock::now();
            double evaluating = 0;
            LeafColumn& column = columns_();
            for (std::size_t c = first; c != last; ++c) {
                if (dirty_[c].exchange(0, std::memory_order_acquire) == 0) continue;
                bool opened = false;
                for (const Interval& interval : positions_.intervalsOf(c))
                    for (int k = interval.first; k <= interval.last; ++k) {
                        const std::size_t slot = interval.slotOf(k);
                        if (queued_[slot].exchange(0, std::memory_order_acquire) == 0) continue;
                        visit(column, opened, c, k, slot, evaluating);
                    }
            }
            addThreadSeconds(secondsSince(start));
            evaluate_seconds_.fetch_add(evaluating, std::memory_order_relaxed);
        });
    }

    void visit(LeafColumn& column, bool& opened, std::size_t c, int k, std::size_t slot, double& evaluating) {
        const LeafMask seeds = seedsOf(c, k);
        if (seeds.empty()) return;
        Cell& cell = cellAt(column, opened, c, k, slot, evaluating);
        const LeafMask before = cell.load();
        const LeafMask after = floodWithin(cell.passable, seeds);
        if (after == before) return;
        cell.store(after);
        if (before.empty()) markNear(c, k);
        LeafMask gained;
        for (std::size_t x = 0; x < 8; ++x) gained.word[x] = after.word[x] & ~before.word[x];
        for (const auto& face : kFaces) {
            if (!touchesFace(gained, face)) continue;
            const std::size_t beside = columnBeside(c, face[0], face[1]);
            if (beside == PlanBins::kNone) continue;
            const SlotOrGap at = positions_.at(beside, k + face[2]);
            if (at.is_slot) {
                queue(beside, at.index);
            } else if (gap_reached_[at.index].exchange(1, std::memory_order_relaxed) == 0) {
                found_gaps_.push_back({beside, at.index - positions_.firstGap(beside)});
            }
        }
    }

    // Visits every leaf position beside one that was reached, on all threads.
    template <typename Body>
    void forEachNear(const Body& body) {
        parallelFor(bins_.size(), kFloodGrain, [&](std::size_t first, std::size_t last) {
            const auto start = Clock::now();
            double evaluating = 0;
            LeafColumn& column = columns_();
            for (std::size_t c = first; c != last; ++c) {
                bool opened = false;
                for (const Interval& interval : positions_.intervalsOf(c))
                    for (int k = interval.first; k <= interval.last; ++k) {
                        const std::size_t slot = interval.slotOf(k);
                        if (near_[slot].load(std::memory_order_relaxed) != 0)
                            body(c, k, slot, [&]() -> Cell& { return cellAt(column, opened, c, k, slot, evaluating); });
                    }
            }
            addThreadSeconds(secondsSince(start));
            evaluate_seconds_.fetch_add(evaluating, std::memory_order_relaxed);
        });
    }

    // Adds openings that are too narrow for the flood, up to ExteriorRule::depth.
    void findShown() {
        for (Cell& cell : cells_) cell.settled = cell.load();
        // First evaluates all leaves that are needed, then finds the shown samples: these depend on complete
        // neighbours.
        forEachNear([this](std::size_t c, int k, std::size_t slot, const auto& cell) {
            if (cells_of_[slot].load(std::memory_order_relaxed) == kUnvisited &&
                anyWithin(masksOf(around(c, k), &Cell::settled), rule_.depth))
                cell();
        });
        forEachNear([this](std::size_t c, int k, std::size_t slot, const auto& cell) {
            if (cells_of_[slot].load(std::memory_order_relaxed) == kUnvisited) return;
            const Around known = around(c, k);
            cell().shown = spreadThrough(masksOf(known, &Cell::outside), masksOf(known, &Cell::settled), rule_.depth);
        });
    }

    // Keeps the voxels within the band around shown ones, and turns the others inside.
    void collect(LeavesByColumn& leaves) {
        std::atomic<std::size_t> kept{0};
        std::atomic<std::size_t> kept_voxels{0};
        forEachNear([&](std::size_t c, int k, std::size_t slot, const auto& of) {
            const std::uint32_t known = cells_of_[slot].load(std::memory_order_relaxed);
            if (known != kUnvisited && !cells_[known].surface) return;
            const Neighbourhood shown = masksOf(around(c, k), &Cell::shown);
            if (known == kUnvisited && !anyWithin(shown, static_cast<int>(rule_.band))) return;
            const LeafMask near = dilateBall(shown, rule_.band);
            if (near.empty()) return;
            Cell& cell = of();
            if (!cell.surface) return;
            // Dropped: samples outside that are not shown, and samples inside that are far from shown ones.
            LeafMask drop;
            for (std::size_t x = 0; x < 8; ++x)
                drop.word[x] = (cell.outside.word[x] & ~cell.shown.word[x]) | (~cell.outside.word[x] & ~near.word[x]);
            const Leaf* leaf = cell.leaf.get();
            if (leaf == nullptr)
                leaf = whole_->probeConstLeaf(openvdb::Coord(bins_.originI(c), bins_.originJ(c), k * kLeafDim));
            const std::size_t active = activeWithout(*leaf, drop);
            if (active == 0) return;
            kept.fetch_add(1, std::memory_order_relaxed);
            kept_voxels.fetch_add(active, std::memory_order_relaxed);
            if (cell.leaf == nullptr) return;
            turnInside(*cell.leaf, drop);
            leaves[c].push_back(std::move(cell.leaf));
        });
        counts_.evaluated = cells_.size();
        counts_.kept = kept;
        counts_.kept_voxels = kept_voxels;
    }

    static std::size_t activeWithout(const Leaf& leaf, const LeafMask& drop) {
        std::size_t count = 0;
        for (openvdb::Index x = 0; x < 8; ++x)
            count += static_cast<std::size_t>(
                std::popcount(leaf.getValueMask().getWord<openvdb::Index64>(x) & ~drop.word[x]));
        return count;
    }

    void turnInside(Leaf& leaf, const LeafMask& drop) const {
        float* values = leaf.buffer().data();
        for (openvdb::Index x = 0; x < 8; ++x) {
            for (std::uint64_t bits = drop.word[x]; bits != 0; bits &= bits - 1)
                values[x * 64 + static_cast<openvdb::Index>(std::countr_zero(bits))] = -rule_.background;
            leaf.getValueMask().getWord<openvdb::Index64>(x) &= ~drop.word[x];
        }
    }

    void addThreadSeconds(double seconds) { thread_seconds_.fetch_add(seconds, std::memory_order_relaxed); }

    const PlanBins& bins_;
    const ColumnSource& columns_;
    const std::uint32_t end_;
    const ExteriorRule rule_;
    const openvdb::FloatTree* const whole_;
    const LeafPositions positions_;

    std::vector<std::atomic<std::uint32_t>> cells_of_;  // by slot: index into cells_
    tbb::concurrent_vector<Cell> cells_;
    std::vector<std::atomic<std::uint8_t>> queued_, near_;        // by slot
    std::vector<std::atomic<std::uint8_t>> dirty_, gap_reached_;  // by column, by gap
    struct Gap {
        std::size_t column, number;
    };
    std::vector<Gap> new_gaps_;
    tbb::concurrent_vector<Gap> found_gaps_;
    std::atomic<double> thread_seconds_{0}, evaluate_seconds_{0};
    ExteriorCounts counts_;
};

}  // namespace

ExteriorCounts buildReachable(const PlanBins& bins, const ColumnSource& columns, std::uint32_t end,
                              const ExteriorRule& rule, LeavesByColumn& leaves,
                              const std::function<void(double)>& progress) {
    leaves.clear();
    leaves.resize(bins.size());
    return Flood(bins, columns, end, rule, nullptr).run(leaves, progress);
}

ExteriorCounts countReachable(const PlanBins& bins, const ColumnSource& columns, std::uint32_t end,
                              const ExteriorRule& rule, const openvdb::FloatTree& whole) {
    LeavesByColumn none;
    return Flood(bins, columns, end, rule, &whole).run(none, {});
}

}  // namespace stratum::voxelize
