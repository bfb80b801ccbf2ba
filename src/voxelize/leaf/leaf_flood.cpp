#include "voxelize/leaf/leaf_flood.h"

#include "base/parallel_for.h"

#include <algorithm>

namespace stratum::voxelize {
namespace {

constexpr std::size_t kFloodGrain = 8;  // columns
constexpr int kFaces[6][3] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
constexpr int kSides = 4;  // of the faces: those across x and y
constexpr std::uint64_t kLowZ = 0x0101010101010101U;
constexpr std::uint64_t kHighZ = 0x8080808080808080U;

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
    if (face < 2) {
        seeds.word[face == 0 ? 0 : 7] |= beyond.word[face == 0 ? 7 : 0];
        return;
    }
    for (std::size_t x = 0; x < 8; ++x) {
        const std::uint64_t word = beyond.word[x];
        if (face == 2) seeds.word[x] |= word >> 56;
        if (face == 3) seeds.word[x] |= word << 56;
        if (face == 4) seeds.word[x] |= (word & kHighZ) >> 7;
        if (face == 5) seeds.word[x] |= (word & kLowZ) << 7;
    }
}

std::atomic_ref<std::uint64_t> wordOf(LeafMask& mask, std::size_t x) {
    return std::atomic_ref<std::uint64_t>(mask.word[x]);
}

}  // namespace

// The flood goes in rounds over the columns with queued leaves. Only the thread that works on a column writes the words
// of its leaves, and other threads read them meanwhile. Bits are only ever set, and who sets a bit queues the
// neighbours that it concerns, so a bit that a reader misses is seen in the next round: queueing is a release
// operation, taking from the queue an acquire one. They are exchanges, not stores: two threads may queue one leaf, and
// who takes it must see the writes of both.
LeafFlood::LeafFlood(const LeafPositions& positions, const Passable& passable, std::span<const std::uint8_t> solid_gaps)
    : positions_(positions),
      passable_(passable),
      solid_gaps_(solid_gaps),
      cell_of_(positions.slotCount()),
      queued_(positions.slotCount()),
      dirty_(positions.columnCount()),
      gaps_(positions.gapCount()) {
    for (auto& cell : cell_of_) cell.store(kUnasked, std::memory_order_relaxed);
}

int LeafFlood::run(const std::function<void(double)>& progress) {
    begin();
    std::vector<std::size_t> round;
    for (int rounds = 0;; ++rounds) {
        floodGaps();
        if (next_.empty()) return rounds;
        round.assign(next_.begin(), next_.end());
        next_.clear();
        // In the order of memory; the order of the threads must not matter, and does not.
        std::sort(round.begin(), round.end());
        parallelFor(round.size(), kFloodGrain, [&](std::size_t first, std::size_t last) {
            for (std::size_t n = first; n != last; ++n) spreadIn(round[n]);
        });
        if (progress) progress(static_cast<double>(cells_.size()) / static_cast<double>(positions_.slotCount()));
    }
}

// The gaps below and above every column are reached, and whatever lies beside a place without one.
void LeafFlood::begin() {
    for (std::size_t c = 0; c < positions_.columnCount(); ++c) {
        const auto intervals = positions_.intervalsOf(c);
        reachGap(c, 0);
        if (!intervals.empty()) reachGap(c, intervals.size());
        if (!freeBeside(c)) continue;
        for (std::size_t n = 1; n < intervals.size(); ++n) reachGap(c, n);
        for (const LeafPositions::Interval& interval : intervals)
            for (int k = interval.first; k <= interval.last; ++k) queue(c, interval.slotOf(k));
    }
}

// The column beyond a face of a leaf, its own for those along z; kNowhere where none is.
std::size_t LeafFlood::columnBeyond(std::size_t c, int face) const {
    if (face >= kSides) return c;
    return positions_.columnAt(positions_.columnI(c) + kFaces[face][0], positions_.columnJ(c) + kFaces[face][1]);
}

bool LeafFlood::freeBeside(std::size_t c) const {
    for (int face = 0; face < kSides; ++face)
        if (columnBeyond(c, face) == LeafPositions::kNowhere) return true;
    return false;
}

void LeafFlood::reachGap(std::size_t c, std::size_t number) {
    const std::size_t gap = positions_.firstGap(c) + number;
    if (!solid_gaps_.empty() && solid_gaps_[gap] != 0) return;
    if (gaps_[gap].exchange(1, std::memory_order_relaxed) == 0) new_gaps_.push_back({c, number});
}

void LeafFlood::queue(std::size_t c, std::size_t slot) {
    if (queued_[slot].exchange(1, std::memory_order_acq_rel) != 0) return;
    if (dirty_[c].exchange(1, std::memory_order_acq_rel) == 0) next_.push_back(c);
}

// From the gaps that were reached into the leaves and gaps around them.
void LeafFlood::floodGaps() {
    std::vector<Gap> work;
    while (!new_gaps_.empty()) {
        work.assign(new_gaps_.begin(), new_gaps_.end());
        new_gaps_.clear();
        for (const Gap& gap : work) leaveGap(gap);
    }
}

void LeafFlood::leaveGap(const Gap& gap) {
    const LeafPositions::Range range = positions_.gapRange(gap.column, gap.number);
    const auto own = positions_.intervalsOf(gap.column);
    if (gap.number > 0) queue(gap.column, own[gap.number - 1].slotOf(own[gap.number - 1].last));
    if (gap.number < own.size()) queue(gap.column, own[gap.number].slot);
    for (int face = 0; face < kSides; ++face) {
        const std::size_t beside = columnBeyond(gap.column, face);
        if (beside == LeafPositions::kNowhere) continue;
        const auto intervals = positions_.intervalsOf(beside);
        for (const LeafPositions::Interval& interval : intervals)
            for (int k = std::max(interval.first, range.low); k < std::min(interval.last + 1, range.high); ++k)
                queue(beside, interval.slotOf(k));
        for (std::size_t n = 0; n <= intervals.size(); ++n) {
            const LeafPositions::Range other = positions_.gapRange(beside, n);
            if (std::max(other.low, range.low) < std::min(other.high, range.high)) reachGap(beside, n);
        }
    }
}

void LeafFlood::spreadIn(std::size_t c) {
    dirty_[c].exchange(0, std::memory_order_acq_rel);
    for (const LeafPositions::Interval& interval : positions_.intervalsOf(c))
        for (int k = interval.first; k <= interval.last; ++k) {
            const std::size_t slot = interval.slotOf(k);
            if (queued_[slot].load(std::memory_order_relaxed) == 0) continue;
            queued_[slot].exchange(0, std::memory_order_acq_rel);
            visit(c, k, slot);
        }
}

LeafMask LeafFlood::load(std::size_t slot) const {
    LeafMask mask;
    const std::uint32_t cell = cell_of_[slot].load(std::memory_order_acquire);
    if (cell == kUnasked) return mask;
    LeafMask& reached = cells_[cell].reached;
    for (std::size_t x = 0; x < 8; ++x) mask.word[x] = wordOf(reached, x).load(std::memory_order_relaxed);
    return mask;
}

LeafMask LeafFlood::seedsOf(std::size_t c, int k, const LeafMask& own) const {
    LeafMask seeds = own;
    for (int face = 0; face < 6; ++face) {
        const std::size_t beyond = columnBeyond(c, face);
        const LeafPositions::Place place =
            beyond == LeafPositions::kNowhere ? LeafPositions::Place{} : positions_.at(beyond, k + kFaces[face][2]);
        if (place.leaf) {
            addFrom(load(place.index), face, seeds);
        } else if (place.index == LeafPositions::kNowhere || reachedGap(place.index)) {
            const LeafMask whole = faceOf(face);
            for (std::size_t x = 0; x < 8; ++x) seeds.word[x] |= whole.word[x];
        }
    }
    return seeds;
}

void LeafFlood::visit(std::size_t c, int k, std::size_t slot) {
    const LeafMask before = load(slot);
    const LeafMask seeds = seedsOf(c, k, before);
    if (seeds == before) return;
    std::uint32_t number = cell_of_[slot].load(std::memory_order_relaxed);
    if (number == kUnasked) {
        const auto added = cells_.push_back({passable_(c, k, slot), {}});
        number = static_cast<std::uint32_t>(added - cells_.begin());
        cell_of_[slot].store(number, std::memory_order_release);
    }
    Cell& cell = cells_[number];
    const LeafMask after = floodWithin(cell.passable, seeds);
    if (after == before) return;
    LeafMask gained;
    for (std::size_t x = 0; x < 8; ++x) {
        wordOf(cell.reached, x).store(after.word[x], std::memory_order_relaxed);
        gained.word[x] = after.word[x] & ~before.word[x];
    }
    for (int face = 0; face < 6; ++face) {
        const LeafMask on = faceOf(face);
        std::uint64_t any = 0;
        for (std::size_t x = 0; x < 8; ++x) any |= gained.word[x] & on.word[x];
        if (any == 0) continue;
        const std::size_t beyond = columnBeyond(c, face);
        if (beyond == LeafPositions::kNowhere) continue;
        const LeafPositions::Place place = positions_.at(beyond, k + kFaces[face][2]);
        if (place.leaf)
            queue(beyond, place.index);
        else
            reachGap(beyond, place.index - positions_.firstGap(beyond));
    }
}

}  // namespace stratum::voxelize
