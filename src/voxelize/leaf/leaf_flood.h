// Which samples of leaves can be reached from outside, step by step over the faces of voxels.
#pragma once

#include "voxelize/leaf/leaf_mask.h"
#include "voxelize/leaf/leaf_positions.h"

#include <tbb/concurrent_vector.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace stratum::voxelize {

/// A flood from around the part. Leaves that it does not come to are never asked for. Parallel; the result does not
/// depend on the number of threads.
class LeafFlood {
public:
    /// The samples of a leaf position that the flood may take: asked for once each. Calls for one column come one at a
    /// time, from any thread.
    using Passable = std::function<LeafMask(std::size_t column, int k, std::size_t slot)>;

    /// `solid_gaps`: by gap, not 0 where the flood may not pass; empty: it may pass all. All must outlive the object.
    LeafFlood(const LeafPositions& positions, const Passable& passable, std::span<const std::uint8_t> solid_gaps = {});

    /// Returns how many rounds it took. `progress` gets the share of all positions asked for so far.
    int run(const std::function<void(double)>& progress = {});

    /// After run(): what of a slot was reached; null for nothing.
    const LeafMask* reached(std::size_t slot) const {
        const std::uint32_t cell = cell_of_[slot].load(std::memory_order_relaxed);
        return cell == kUnasked ? nullptr : &cells_[cell].reached;
    }
    bool reachedGap(std::size_t gap) const { return gaps_[gap].load(std::memory_order_relaxed) != 0; }

private:
    struct Cell {
        LeafMask passable, reached;
    };
    struct Gap {
        std::size_t column, number;
    };
    static constexpr std::uint32_t kUnasked = 0xffffffff;

    void begin();
    std::size_t columnBeyond(std::size_t c, int face) const;
    bool freeBeside(std::size_t c) const;
    void reachGap(std::size_t c, std::size_t number);
    void queue(std::size_t c, std::size_t slot);
    void floodGaps();
    void leaveGap(const Gap& gap);
    void spreadIn(std::size_t c);
    void visit(std::size_t c, int k, std::size_t slot);
    LeafMask seedsOf(std::size_t c, int k, const LeafMask& own) const;
    LeafMask load(std::size_t slot) const;

    const LeafPositions& positions_;
    const Passable& passable_;
    const std::span<const std::uint8_t> solid_gaps_;
    std::vector<std::atomic<std::uint32_t>> cell_of_;  // by slot: index into cells_
    mutable tbb::concurrent_vector<Cell> cells_;       // `reached` by atomic_ref, which wants no const
    std::vector<std::atomic<std::uint8_t>> queued_;    // by slot
    std::vector<std::atomic<std::uint8_t>> dirty_;     // by column: has queued slots
    std::vector<std::atomic<std::uint8_t>> gaps_;      // reached
    tbb::concurrent_vector<std::size_t> next_;         // dirty columns
    tbb::concurrent_vector<Gap> new_gaps_;
};

}  // namespace stratum::voxelize
