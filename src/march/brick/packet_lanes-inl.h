// A packet of rays, one in each lane of a vector, for one Highway target at a time, hence the guard that toggles.
//
// In lanes all directions are positive: for an axis with a negative direction, origin and direction are negated, which
// is exact, and cell c becomes ~c, so that all lanes advance alike and aligned blocks stay aligned.
#if defined(STRATUM_PACKET_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef STRATUM_PACKET_LANES_INL_H
#undef STRATUM_PACKET_LANES_INL_H
#else
#define STRATUM_PACKET_LANES_INL_H
#endif

#include "march/brick/brick_grid.h"
#include "march/brick/brick_walk.h"
#include "march/brick/lanes-inl.h"

#include <hwy/highway.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#if STRATUM_WIDE_LANES
HWY_BEFORE_NAMESPACE();
namespace stratum::march {
namespace HWY_NAMESPACE {

/// The state of a lane; one array each. Cells and flips are whole numbers.
enum Field {
    kO,  // from here on with positive directions, see above
    kD = kO + 3,
    kInverse = kD + 3,  // infinite along axes along which the ray doesn't move
    kCell = kInverse + 3,
    kFlip = kCell + 3,  // -1 where the direction is negative, or 0: cell ^ flip is the real cell
    kEnd = kFlip + 3,
    kStart,
    kIndex,
    kT,       // from the entry into the box on
    kFace,    // axis of the face that the cell was entered by, or -1
    kMacro,   // where the cell's macro cell is in the table, bytes
    kQueued,  // fields that a ray in the queue has
    // By Marcher::look(): in a brick, eight times its index and the number of its 4^3 cells, and -1; elsewhere, 0, and
    // how far the empty block reaches: over all cells that differ in the low bits only, and so many more ahead.
    kPart = kQueued,
    kWord,  // of clearCells(): kPart, or the same of the slot
    kLowBits,
    kBeyond,
    kFields
};

struct Packet {
    HWY_ALIGN double field[kFields][kLanes];
    HWY_ALIGN std::int64_t sample[kLanes] = {};  // of a waiting lane: index of its cell's first corner; of others 0
    unsigned alive = 0, waiting = 0;
};

HWY_INLINE V load(const Packet& p, int field) { return hn::Load(D(), p.field[field]); }
HWY_INLINE void store(Packet& p, int field, V v) { hn::Store(v, D(), p.field[field]); }
HWY_INLINE VI loadWhole(const Packet& p, int field) { return hn::BitCast(DI(), load(p, field)); }
HWY_INLINE void storeWhole(Packet& p, int field, VI v) { store(p, field, hn::BitCast(D(), v)); }

/// Rays in cells: origin, direction and its inverse; a direction too small to invert is 0, its inverse infinite.
struct LaneRays {
    V o[3], dir[3], inverse[3];
};

/// The fields of the first `count` rays, 1 to kLanes; the other lanes repeat the last one.
HWY_INLINE void loadRays(const trace::Ray* rays, int count, V in[8]) {
    static_assert(sizeof(trace::Ray) == 8 * sizeof(double));
    const D d;
    const double* fields = &rays->origin.x;
    if (count == kLanes) {
        // Two blocks of four fields a ray, transposed: gathers read one field of one ray at a time.
        V low[4];
        V high[4];
        hn::LoadInterleaved4(d, fields, low[0], low[1], low[2], low[3]);
        hn::LoadInterleaved4(d, fields + 4 * kLanes, high[0], high[1], high[2], high[3]);
        for (int n = 0; n < 4; ++n) {
            in[n] = hn::ConcatEven(d, high[n], low[n]);
            in[n + 4] = hn::ConcatOdd(d, high[n], low[n]);
        }
        return;
    }
    const VI row = hn::ShiftLeft<3>(hn::Min(hn::Iota(DI(), 0), whole(count - 1)));
    for (int n = 0; n < 8; ++n) in[n] = hn::GatherIndex(d, fields, row + whole(n));
}

/// The grid's table of macro cells.
class MacroTable {
public:
    explicit MacroTable(const BrickGrid& grid)
        : cells_(reinterpret_cast<const std::byte*>(grid.macroCells())),
          count_y_(grid.size()[1] / BrickGrid::kMacroEdge),
          count_z_(grid.size()[2] / BrickGrid::kMacroEdge),
          large_(std::int64_t{grid.size()[0] / BrickGrid::kMacroEdge} * count_y_ * count_z_ >= kLarge) {}

    /// Whether to prefetch an entry when a ray comes to it: a small table stays in the caches.
    bool large() const { return large_; }
    /// Where the macro cell of a cell is, bytes.
    HWY_INLINE VI at(const VI cell[3]) const {
        static_assert(BrickGrid::kMacroEdge == 1 << 5);
        const VI row = product(hn::ShiftRight<5>(cell[0]), whole(count_y_)) + hn::ShiftRight<5>(cell[1]);
        return hn::ShiftLeft<4>(product(row, whole(count_z_)) + hn::ShiftRight<5>(cell[2]));
    }
    /// The bricks of each, and what else they have.
    HWY_INLINE Halves read(const Kept& places) const {
        static_assert(sizeof(MacroCell) == 1 << 4);
        return loadHalves(cells_, places);
    }
    HWY_INLINE void prefetch(const Kept& places) const { march::HWY_NAMESPACE::prefetch(cells_, places); }

private:
    static constexpr std::int64_t kLarge = std::int64_t{1} << 16;  // a megabyte

    const std::byte* const cells_;
    const std::int64_t count_y_, count_z_;
    const bool large_;
};

/// From rays in the world to rays in the grid's box.
class RayBox {
public:
    RayBox(const BrickGrid& grid, const CellMap& map) : map_(map) {
        for (int axis = 0; axis < 3; ++axis) {
            whole_size_[axis] = grid.size()[static_cast<std::size_t>(axis)];
            size_[axis] = static_cast<double>(whole_size_[axis]);
            last_position_[axis] = std::nextafter(size_[axis], 0.0);
        }
    }

    /// `in`: the fields of trace::Ray.
    HWY_INLINE void toCells(const V in[8], LaneRays& lanes) const {
        for (int axis = 0; axis < 3; ++axis) {
            lanes.o[axis] = across(axis, in) + constant(map_.origin[axis]);
            lanes.dir[axis] = across(axis, in + 3);
        }
        invert(lanes);
    }
    /// Of a direction, in cells.
    HWY_INLINE V across(int axis, const V v[3]) const {
        return constant(map_.to_cells[0][axis]) * v[0] + constant(map_.to_cells[1][axis]) * v[1] +
               constant(map_.to_cells[2][axis]) * v[2];
    }
    /// Inverses, of directions in cells.
    static HWY_INLINE void invert(LaneRays& lanes) {
        const V infinity = constant(std::numeric_limits<double>::infinity());
        const V largest = constant(std::numeric_limits<double>::max());
        for (int axis = 0; axis < 3; ++axis) {
            lanes.inverse[axis] = constant(1) / lanes.dir[axis];
            const M finite = hn::Le(hn::Abs(lanes.inverse[axis]), largest);
            lanes.dir[axis] = hn::IfThenElseZero(finite, lanes.dir[axis]);
            lanes.inverse[axis] = hn::IfThenElse(finite, lanes.inverse[axis], infinity);
        }
    }

    /// Shortens rays to their parts in the grid's box; returns which have one.
    HWY_INLINE M clip(const LaneRays& lanes, V& start, V& end) const {
        const V zero = hn::Zero(D());
        M good = hn::Eq(zero, zero);
        for (int axis = 0; axis < 3; ++axis) {
            const V extent = constant(size_[axis]);
            const M still = hn::Eq(lanes.dir[axis], zero);
            const M between = hn::And(hn::Ge(lanes.o[axis], zero), hn::Le(lanes.o[axis], extent));
            const V a = hn::Neg(lanes.o[axis]) * lanes.inverse[axis];
            const V b = (extent - lanes.o[axis]) * lanes.inverse[axis];
            const M swap = hn::Gt(a, b);
            const V near = hn::IfThenElse(swap, b, a);
            const V far = hn::IfThenElse(swap, a, b);
            good = hn::And(good, hn::Or(hn::And(still, between), hn::AndNot(still, hn::Le(near, far))));
            // std::max and std::min keep their first argument unless the second is beyond it.
            start = hn::IfThenElse(hn::AndNot(still, hn::Lt(start, near)), near, start);
            end = hn::IfThenElse(hn::AndNot(still, hn::Lt(far, end)), far, end);
        }
        const V infinity = constant(std::numeric_limits<double>::infinity());
        return hn::And(good, hn::And(hn::Le(start, end), hn::Lt(hn::Abs(start), infinity)));
    }

    /// Position and direction at the start, mirrored so that every direction ascends.
    HWY_INLINE void mirror(const LaneRays& lanes, V start, V out[kQueued]) const {
        const D d;
        for (int axis = 0; axis < 3; ++axis) {
            const M still = hn::Eq(lanes.dir[axis], hn::Zero(d));
            const V at = lanes.o[axis] + start * lanes.dir[axis];
            const V within = hn::IfThenElse(still, hn::Min(at, constant(last_position_[axis])), at);
            const V sign = hn::And(lanes.dir[axis], constant(-0.0));
            const VI flip = hn::BroadcastSignBit(hn::BitCast(DI(), hn::IfThenZeroElse(still, sign)));
            const V back = hn::And(hn::BitCast(d, flip), constant(-0.0));
            out[kO + axis] = hn::Xor(within, back);
            out[kD + axis] = hn::Abs(lanes.dir[axis]);
            out[kInverse + axis] = hn::Abs(lanes.inverse[axis]);
            out[kFlip + axis] = hn::BitCast(d, flip);
        }
    }
    /// The cell at out[kT] along an axis, after mirror().
    HWY_INLINE VI cellAt(int axis, const V out[kQueued]) const {
        const VI size = whole(whole_size_[axis]);
        const VI least = hn::Neg(hn::And(hn::BitCast(DI(), out[kFlip + axis]), size));
        const VI cell = floorToWhole(out[kO + axis] + out[kT] * out[kD + axis]);
        return hn::Min(hn::Max(cell, least), least + size - whole(1));
    }

private:
    const CellMap& map_;
    double size_[3];
    double last_position_[3];  // just below the box's far faces
    std::int64_t whole_size_[3];
};

}  // namespace HWY_NAMESPACE
}  // namespace stratum::march
HWY_AFTER_NAMESPACE();
#endif  // STRATUM_WIDE_LANES

#endif
