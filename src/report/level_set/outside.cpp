#include "report/level_set/outside.h"

#include "base/parallel_for.h"
#include "voxelize/grid/exterior.h"
#include "voxelize/leaf/leaf_kernels.h"

#include <tbb/concurrent_vector.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numeric>

namespace stratum::report {
namespace {

using voxelize::LeafMask;

constexpr std::size_t kFloodGrain = 64;
constexpr int kNeighbours[6][3] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
constexpr std::uint64_t kLowZ = 0x0101010101010101U;
constexpr std::uint64_t kHighZ = 0x8080808080808080U;

LeafMask openSamples(const Leaf& leaf, float least) {
    LeafMask mask;
    voxelize::maskFrom(leaf.buffer().data(), least, mask.word.data());
    return mask;
}

// The samples of one face of a leaf.
LeafMask faceOf(int face) {
    LeafMask mask;
    if (face < 2)
        mask.word[face == 0 ? 0 : 7] = ~std::uint64_t{0};
    else
        mask.word.fill(face == 2 ? 0xffU : face == 3 ? std::uint64_t{0xff} << 56 : face == 4 ? kLowZ : kHighZ);
    return mask;
}

// What of a neighbour beyond a face lies beside the samples of that face.
void addFrom(const LeafMask& beyond, int face, LeafMask& seeds) {
    for (std::size_t x = 0; x < 8; ++x) {
        const std::uint64_t word = beyond.word[x];
        if (face == 0 && x == 7) seeds.word[0] |= word;
        if (face == 1 && x == 0) seeds.word[7] |= word;
        if (face == 2) seeds.word[x] |= word >> 56;
        if (face == 3) seeds.word[x] |= word << 56;
        if (face == 4) seeds.word[x] |= (word & kHighZ) >> 7;
        if (face == 5) seeds.word[x] |= (word & kLowZ) << 7;
    }
}

// The flood goes in rounds over the leaves that were queued. Only the thread that works on a leaf writes its words, and
// other threads read them meanwhile. Bits are only ever set, and who sets a bit queues the neighbours that it concerns,
// so a bit that a reader misses is seen in the next round: queueing is a release operation, taking an acquire one.
class Flood {
public:
    // `open`: the samples that it may take; null to find those of `least` or more when they are needed.
    Flood(const LeafMap& map, float least, const std::vector<LeafMask>* open = nullptr)
        : map_(map),
          least_(least),
          open_(open),
          reached_(map.leafCount()),
          queued_(map.leafCount()),
          gaps_(map.gapCount()) {}

    void run() {
        for (std::size_t c = 0; c < map_.columnCount(); ++c) {
            const std::size_t last = map_.firstLeaf(c + 1) - map_.firstLeaf(c);
            reachGap(c, 0);
            reachGap(c, last);
            if (freeBeside(c))
                for (std::size_t n = 1; n < last; ++n) reachGap(c, n);
        }
        std::vector<std::size_t> round(map_.leafCount());
        std::iota(round.begin(), round.end(), std::size_t{0});
        for (auto& queued : queued_) queued.store(1, std::memory_order_relaxed);
        while (true) {
            floodGaps();
            if (round.empty() && next_.empty()) return;
            round.insert(round.end(), next_.begin(), next_.end());
            next_.clear();
            // In the order of memory; the order of the threads must not matter, and does not.
            if (round.size() < map_.leafCount()) std::sort(round.begin(), round.end());
            parallelFor(round.size(), kFloodGrain, [&](std::size_t first, std::size_t last) {
                for (std::size_t n = first; n != last; ++n) visit(round[n]);
            });
            round.clear();
        }
    }

    std::vector<LeafMask> reached() const {
        std::vector<LeafMask> masks(reached_.size());
        parallelFor(masks.size(), kFloodGrain * 16, [&](std::size_t first, std::size_t last) {
            for (std::size_t n = first; n != last; ++n) masks[n] = load(n);
        });
        return masks;
    }
    std::vector<std::uint8_t> gaps() const {
        std::vector<std::uint8_t> reached(gaps_.size());
        for (std::size_t n = 0; n < reached.size(); ++n) reached[n] = gaps_[n].load(std::memory_order_relaxed);
        return reached;
    }

private:
    struct Gap {
        std::size_t column, number;
    };

    LeafMask load(std::size_t n) const {
        LeafMask mask;
        for (std::size_t x = 0; x < 8; ++x) mask.word[x] = reached_[n][x].load(std::memory_order_relaxed);
        return mask;
    }
    void queue(std::size_t leaf) {
        if (queued_[leaf].exchange(1, std::memory_order_acq_rel) == 0) next_.push_back(leaf);
    }
    // Whether a place beside a column has none: it is outside as far as it is high.
    bool freeBeside(std::size_t c) const {
        return std::any_of(std::begin(kNeighbours), std::begin(kNeighbours) + 4, [&](const auto& step) {
            return map_.columnAt(map_.columnI(c) + step[0], map_.columnJ(c) + step[1]) == LeafMap::kNowhere;
        });
    }
    void reachGap(std::size_t c, std::size_t number) {
        const std::size_t gap = map_.firstGap(c) + number;
        if (!map_.gapInside(gap) && gaps_[gap].exchange(1, std::memory_order_relaxed) == 0)
            new_gaps_.push_back({c, number});
    }

    // From the gaps that were reached into the leaves and gaps around them.
    void floodGaps() {
        std::vector<Gap> work;
        while (!new_gaps_.empty()) {
            work.assign(new_gaps_.begin(), new_gaps_.end());
            new_gaps_.clear();
            for (const Gap& gap : work) leaveGap(gap);
        }
    }
    void leaveGap(const Gap& gap) {
        const LeafMap::Range range = map_.gapRange(gap.column, gap.number);
        if (range.low == range.high) return;
        const std::size_t first = map_.firstLeaf(gap.column);
        if (gap.number > 0) queue(first + gap.number - 1);
        if (first + gap.number < map_.firstLeaf(gap.column + 1)) queue(first + gap.number);
        for (int face = 0; face < 4; ++face) {
            const std::size_t c = map_.columnAt(map_.columnI(gap.column) + kNeighbours[face][0],
                                                map_.columnJ(gap.column) + kNeighbours[face][1]);
            if (c == LeafMap::kNowhere) continue;
            const LeafMap::Place low = map_.at(c, range.low);
            const std::size_t begin = map_.firstLeaf(c);
            std::size_t n = low.leaf ? low.index : begin + (low.index - map_.firstGap(c));
            // The gap before leaf n, if it meets the range, then leaf by leaf with the gap after each.
            if (!low.leaf) reachGap(c, n - begin);
            for (; n < map_.firstLeaf(c + 1) && map_.leafK(n) < range.high; ++n) {
                queue(n);
                const LeafMap::Range after = map_.gapRange(c, n - begin + 1);
                if (after.low != after.high && after.low < range.high) reachGap(c, n - begin + 1);
            }
        }
    }

    LeafMask seedsOf(std::size_t n) const {
        LeafMask seeds = load(n);
        const std::size_t c = map_.columnOf(n);
        for (int face = 0; face < 6; ++face) {
            const auto& step = kNeighbours[face];
            const LeafMap::Place place =
                map_.at(map_.columnI(c) + step[0], map_.columnJ(c) + step[1], map_.leafK(n) + step[2]);
            if (place.leaf) {
                addFrom(load(place.index), face, seeds);
            } else if (place.index == LeafMap::kNowhere || gaps_[place.index].load(std::memory_order_relaxed) != 0) {
                const LeafMask whole = faceOf(face);
                for (std::size_t x = 0; x < 8; ++x) seeds.word[x] |= whole.word[x];
            }
        }
        return seeds;
    }

    void visit(std::size_t n) {
        queued_[n].exchange(0, std::memory_order_acq_rel);
        const LeafMask seeds = seedsOf(n);
        if (seeds.empty()) return;
        const LeafMask before = load(n);
        if (seeds == before) return;
        const LeafMask after =
            voxelize::floodWithin(open_ != nullptr ? (*open_)[n] : openSamples(map_.leaf(n), least_), seeds);
        if (after == before) return;
        LeafMask gained;
        for (std::size_t x = 0; x < 8; ++x) {
            reached_[n][x].store(after.word[x], std::memory_order_relaxed);
            gained.word[x] = after.word[x] & ~before.word[x];
        }
        const std::size_t c = map_.columnOf(n);
        for (int face = 0; face < 6; ++face) {
            const LeafMask on = faceOf(face);
            std::uint64_t any = 0;
            for (std::size_t x = 0; x < 8; ++x) any |= gained.word[x] & on.word[x];
            if (any == 0) continue;
            const auto& step = kNeighbours[face];
            const LeafMap::Place place =
                map_.at(map_.columnI(c) + step[0], map_.columnJ(c) + step[1], map_.leafK(n) + step[2]);
            if (place.leaf)
                queue(place.index);
            else if (place.index != LeafMap::kNowhere)
                reachGap(
                    map_.columnAt(map_.columnI(c) + step[0], map_.columnJ(c) + step[1]),
                    place.index - map_.firstGap(map_.columnAt(map_.columnI(c) + step[0], map_.columnJ(c) + step[1])));
        }
    }

    const LeafMap& map_;
    const float least_;
    const std::vector<LeafMask>* const open_;
    std::vector<std::array<std::atomic<std::uint64_t>, 8>> reached_;
    std::vector<std::atomic<std::uint8_t>> queued_;
    std::vector<std::atomic<std::uint8_t>> gaps_;
    tbb::concurrent_vector<std::size_t> next_;
    tbb::concurrent_vector<Gap> new_gaps_;
};

// Masks of a leaf and of those around it. `full` stands for gaps that the flood has reached.
voxelize::Neighbourhood around(const LeafMap& map, std::size_t n, const std::vector<LeafMask>& masks,
                               const std::vector<std::uint8_t>& gaps) {
    static const LeafMask kFull = LeafMask::full();
    voxelize::Neighbourhood out{};
    const std::size_t c = map.columnOf(n);
    for (int dx = -1; dx <= 1; ++dx)
        for (int dy = -1; dy <= 1; ++dy)
            for (int dz = -1; dz <= 1; ++dz) {
                const LeafMap::Place place = map.at(map.columnI(c) + dx, map.columnJ(c) + dy, map.leafK(n) + dz);
                const LeafMask*& mask = out[voxelize::neighbourIndex(dx, dy, dz)];
                if (place.leaf)
                    mask = &masks[place.index];
                else if (place.index == LeafMap::kNowhere || gaps[place.index] != 0)
                    mask = &kFull;
            }
    return out;
}

}  // namespace

Outside::Outside(const LeafMap& map, double clearance, double voxel, double background) {
    clearance = std::min(clearance, background - 0.5 * voxel);
    // From where the ball's middle can be into the bottom of a groove between two round sides of its radius.
    constexpr double kIntoGroove = 1.8;
    const int steps =
        std::max(voxelize::ExteriorRule{}.depth, static_cast<int>(std::ceil(kIntoGroove * clearance / voxel)) + 1);
    const int depth = std::min(steps, voxelize::kFarthestReach);
    std::vector<LeafMask> wide;
    {
        Flood flood(map, static_cast<float>(clearance));
        flood.run();
        wide = flood.reached();
        gap_wide_ = flood.gaps();
    }
    std::vector<LeafMask> open(map.leafCount());
    parallelFor(open.size(), kFloodGrain, [&](std::size_t first, std::size_t last) {
        for (std::size_t n = first; n != last; ++n) open[n] = openSamples(map.leaf(n), 0);
    });
    shown_.resize(map.leafCount());
    parallelFor(shown_.size(), kFloodGrain, [&](std::size_t first, std::size_t last) {
        for (std::size_t n = first; n != last; ++n) {
            // Nothing of a leaf without a place left to reach depends on its neighbours.
            if (open[n].empty() || wide[n] == open[n]) {
                shown_[n] = wide[n];
                continue;
            }
            const voxelize::Neighbourhood seeds = around(map, n, wide, gap_wide_);
            if (voxelize::anyWithin(seeds, depth))
                shown_[n] = voxelize::spreadThrough(around(map, n, open, gap_wide_), seeds, depth);
        }
    });
    wide = {};
    Flood flood(map, 0, &open);
    flood.run();
    any_ = flood.reached();
    gap_any_ = flood.gaps();
}

}  // namespace stratum::report
