// FloatGrid -> bricks: the level set laid out for rays.
//
// Three levels over the cells of the grid (a cell is the cube between eight neighbouring samples):
//   macro cell   32^3 cells, in a dense array: which of its 4^3 bricks have surface, or how far all is empty in the
//                direction of a ray, so that rays leave empty space in large boxes
//   brick        8^3 cells: a bit for every surface cell (corners not of one sign), and the 9^3 samples at its corners
// All coordinates are cells, counted from the grid's lowest corner.
//
// Bricks are laid out at once (eager), or each when the first ray reaches it (lazy). A lazy grid lists a brick for
// every leaf, and all its cells count as surface until it is laid out; so only the visible bricks are laid out. With a
// bound on their number (see brick_slots.h), bricks are evicted and laid out again; their bits of surface cells are
// kept.
#pragma once

#include "base/huge_array.h"
#include "march/brick/brick_layout.h"
#include "march/brick/brick_slots.h"
#include "march/brick/macro_cell.h"
#include "march/file/leaf_field.h"
#include "march/file/leaf_source.h"

#include <openvdb/openvdb.h>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace stratum::march {

// A thread's cache of recently converted leaves, because neighbouring bricks share leaves.

/// The eight leaves of one brick have distinct entries, and so have those of a macro cell and its neighbours.
template <typename T>
class LeafCache {
public:
    struct Entry {
        std::uint64_t key = 0;  // see keyOf()
        bool uniform = false;   // background, all of it
        LeafSamples<T> samples;
        CapSamples<T> above;  // of a field
    };
    static std::uint64_t keyOf(int x, int y, int z) {
        const auto part = [](int c) { return static_cast<std::uint64_t>(c) + 1; };
        return part(x) << 42 | part(y) << 21 | part(z);
    }
    Entry& at(int x, int y, int z) {
        return entries_[static_cast<std::size_t>((x & kLast) << (2 * kBits) | (y & kLast) << kBits | (z & kLast))];
    }
    /// An entry apart for each part of a brick (see BrickParts), of which only what the brick shares need be there.
    Entry& shared(std::size_t part) { return shared_[part]; }

private:
    static constexpr int kBits = 4;
    static constexpr int kLast = (1 << kBits) - 1;
    HugeArray<Entry> entries_{std::size_t{1} << (3 * kBits)};
    std::array<Entry, 4> shared_;
};

class BrickGrid {
public:
    static constexpr int kMacroEdge = 32;  ///< cells
    /// Whether the memory for so many macro cells along each axis is in proportion to the leaves in them.
    static bool canSpan(const std::array<int, 3>& macros, std::size_t leaves);
    static constexpr int kBrickEdge = 8;  ///< cells
    static constexpr int kSamples = kBrickEdge + 1;
    /// Strides of a brick's samples.
    static constexpr std::ptrdiff_t kStrideY = kSamples;
    static constexpr std::ptrdiff_t kStrideX = kStrideY * kSamples;
    static constexpr std::ptrdiff_t kBrickSamples = kStrideX * kSamples;
    static constexpr std::size_t kNoBound = std::numeric_limits<std::size_t>::max();

    /// Eager: lays out every brick, in parallel. The source is not needed afterwards.
    /// Throws InputError, with the size, for a level set whose box holds more than 2^31 macro cells, or 2^20 and 128
    /// for each leaf, or more than fit into half of the free memory, or 2^19 along an axis; and, with the position, for
    /// samples that are no finite numbers.
    BrickGrid(const LeafSource& source, BrickValues values);
    BrickGrid(const openvdb::FloatGrid& grid, BrickValues values) : BrickGrid(GridLeaves(grid), values) {}
    /// Lazy: ensureBrick() lays bricks out, and then throws as above. Samples take at most `cache_bytes` at a time:
    /// throws UsageError if that is less than BrickSlots::kLeastBound bricks.
    BrickGrid(std::shared_ptr<const LeafSource> source, BrickValues values, std::size_t cache_bytes = kNoBound);
    /// Lazy, for samples that are computed when they are needed.
    BrickGrid(std::shared_ptr<const LeafField> field, BrickValues values, std::size_t cache_bytes = kNoBound);
    ~BrickGrid();
    BrickGrid(const BrickGrid&) = delete;
    BrickGrid& operator=(const BrickGrid&) = delete;

    /// Index-space coordinate of cell (0, 0, 0).
    const openvdb::Coord& origin() const { return origin_; }
    /// Cells along each axis: a multiple of kMacroEdge.
    const std::array<int, 3>& size() const { return size_; }

    const MacroCell& macroCell(int x, int y, int z) const { return macro_cells_[macroIndex(x, y, z)]; }
    /// Index of a brick that is set in its macro cell's mask; (x, y, z) in bricks within the macro cell.
    static std::size_t brickIndex(const MacroCell& macro, int x, int y, int z) {
        const std::uint64_t before = (std::uint64_t{1} << Mask64::bit(x, y, z)) - 1;
        return macro.firstBrick() + static_cast<std::size_t>(std::popcount(macro.bricks & before));
    }

    /// For a field that has changed: discards the bricks that have samples of these leaves (index-space coordinates of
    /// their first samples), and updates which macro cells are shown. All other bricks are kept. Not while rays are
    /// traced.
    void update(std::span<const openvdb::Coord> leaves);

    /// Whether bricks are laid out when rays reach them.
    bool lazy() const { return layouter_ != nullptr; }
    /// Lays out the brick at (x, y, z), in bricks, unless it is laid out already. From any thread. False if there is no
    /// free slot.
    bool ensureBrick(std::size_t brick, int x, int y, int z) const;
    /// The slots of the samples. With a bound, hold a Reading from ensureBrick() until the samples have been read, and
    /// call makeRoom() if there is no free slot.
    BrickSlots& cache() const { return slots_; }

    /// The surface cells among 4^3 of a brick's, `part` = x << 2 | y << 1 | z; all, before it is laid out.
    std::uint64_t surface(std::size_t brick, std::size_t part) const {
        return ~std::atomic_ref(clear_.data()[bitsOf(brick)][part]).load(std::memory_order_relaxed);
    }
    /// The same after ensureBrick() of the brick that contains `cell`; waits for a free slot.
    std::uint64_t ensureSurface(std::size_t brick, std::size_t part, const glm::ivec3& cell) const;
    /// Where the samples of a brick with surface begin, in units of samples.
    std::size_t firstSample(std::size_t brick) const {
        if (lazy()) [[unlikely]]
            brick = slots_.of(brick) - BrickSlots::kFirst;
        return brick * static_cast<std::size_t>(kBrickSamples);
    }
    BrickValues values() const { return values_; }
    /// All samples; x slowest in a brick. Only the one of values() exists.
    const float* floats() const { return floats_.data(); }
    const std::int16_t* quanta() const { return quanta_.data(); }
    /// World units of 1 in the samples.
    double unit() const { return unit_; }

    /// The same data as arrays, for vector code.
    const MacroCell* macroCells() const { return macro_cells_.data(); }
    /// Complements of the surface cells, by brick; or by slots(), see bitsBySlot(): none is clear of a brick that isn't
    /// laid out, and all are of one without surface.
    const CellBits* clearCells() const { return clear_.data(); }
    /// In a lazy grid without a bound, bits are beside the samples: memory is touched for bricks that are laid out, not
    /// for all that are listed. Evicted bricks keep their bits, so a grid with a bound has them by brick.
    bool bitsBySlot() const { return bits_by_slot_; }
    /// Of a lazy grid: each brick's slot, BrickSlots::table(). In an eager grid samples are in the order of the bricks.
    const std::uint32_t* slots() const { return slots_.table(); }

    /// Bricks that have an index.
    std::size_t listedCount() const { return listed_; }
    /// Bricks with surface that are laid out.
    std::size_t brickCount() const { return slots_.taken(); }
    /// Memory of a brick's samples.
    std::size_t brickBytes() const {
        return static_cast<std::size_t>(kBrickSamples) *
               (values_ == BrickValues::Float32 ? sizeof(float) : sizeof(std::int16_t));
    }
    /// Memory of all, bytes.
    std::size_t bytes() const;

private:
    class Layouter;

    std::size_t bitsOf(std::size_t brick) const { return bitsBySlot() ? slots_.of(brick) : brick; }
    std::size_t macroIndex(int x, int y, int z) const {
        return (static_cast<std::size_t>(x) * static_cast<std::size_t>(macros_[1]) + static_cast<std::size_t>(y)) *
                   static_cast<std::size_t>(macros_[2]) +
               static_cast<std::size_t>(z);
    }
    MacroCell& macroOf(const openvdb::Coord& cell) {
        return macro_cells_[macroIndex(cell[0] / kMacroEdge, cell[1] / kMacroEdge, cell[2] / kMacroEdge)];
    }
    std::vector<std::uint32_t> listBricks(const LeafSource& source, bool lazy, std::size_t cache_bytes);
    void listBricks(const LeafField& field, std::size_t cache_bytes);
    void setBox(const openvdb::Coord& origin, const std::array<int, 3>& macros, std::size_t leaves);
    void countBricks(bool lazy, std::size_t cache_bytes);
    void numberBricks();

    openvdb::Coord origin_;
    std::array<int, 3> macros_{};
    std::array<int, 3> size_{};
    BrickValues values_;
    double unit_ = 1;
    HugeArray<MacroCell> macro_cells_;
    std::size_t listed_ = 0;  // bricks that have an index
    bool bits_by_slot_ = false;
    // Mutable: a lazy grid lays out bricks while const tracers read it.
    mutable HugeArray<CellBits> clear_;
    mutable BrickSlots slots_;
    mutable HugeArray<float> floats_;
    mutable HugeArray<std::int16_t> quanta_;
    std::unique_ptr<const Layouter> layouter_;
};

}  // namespace stratum::march
