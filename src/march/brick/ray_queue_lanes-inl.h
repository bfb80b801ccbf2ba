// The queue that feeds rays into the lanes of packets, for one Highway target at a time, hence the guard that toggles.
//
// Rays wait in a queue, already clipped to the box. A packet holds as many rays as a vector has lanes; a lane whose ray
// ends takes the next from the queue.
//
// In lanes all directions are positive: for an axis with a negative direction, origin and direction are negated, which
// is exact, and cell c becomes ~c, so that all lanes advance alike and aligned blocks stay aligned.
#if defined(STRATUM_RAY_QUEUE_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef STRATUM_RAY_QUEUE_LANES_INL_H
#undef STRATUM_RAY_QUEUE_LANES_INL_H
#else
#define STRATUM_RAY_QUEUE_LANES_INL_H
#endif

#include "march/brick/beam.h"
#include "march/brick/brick_walk.h"
#include "march/brick/lanes-inl.h"
#include "trace/intersector.h"

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#if STRATUM_WIDE_LANES
HWY_BEFORE_NAMESPACE();
namespace stratum::march {
namespace HWY_NAMESPACE {

constexpr int kRefill = kLanes / 4;  // lanes without a ray that make a refill worthwhile
constexpr int kQueue = 8 * kLanes;   // rays

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
    kT,               // from the entry into the box on
    kQueued,          // fields that a ray in the queue has
    kFace = kQueued,  // axis of the face that the cell was entered by, or -1
    // By Marcher::look(): in a brick, the word of clearCells(), and -1; elsewhere, 0, and how far the empty block
    // reaches: over all cells that differ in the low bits only, and so many more ahead.
    kPart,
    kLowBits,
    kBeyond,
    kFields
};

struct Packet {
    HWY_ALIGN double field[kFields][kLanes];
    HWY_ALIGN std::int64_t sample[kLanes] = {};  // of a waiting lane: index of its cell's first corner
    unsigned alive = 0, waiting = 0;
};

HWY_INLINE V load(const Packet& p, int field) { return hn::Load(D(), p.field[field]); }
HWY_INLINE void store(Packet& p, int field, V v) { hn::Store(v, D(), p.field[field]); }
HWY_INLINE VI loadWhole(const Packet& p, int field) { return hn::BitCast(DI(), load(p, field)); }
HWY_INLINE void storeWhole(Packet& p, int field, VI v) { store(p, field, hn::BitCast(D(), v)); }

/// With kBeams, for rays that may all begin at one eye: then Beam finds where they start.
template <bool kBeams>
class RayQueue {
public:
    RayQueue(const BrickGrid& grid, const CellMap& map, std::span<const trace::Ray> rays)
        : map_(map), rays_(rays), beams_(grid, map) {
        for (int axis = 0; axis < 3; ++axis) {
            whole_size_[axis] = grid.size()[static_cast<std::size_t>(axis)];
            size_[axis] = static_cast<double>(whole_size_[axis]);
            last_position_[axis] = std::nextafter(size_[axis], 0.0);
        }
    }

    /// Gives rays to the lanes that have none, once there are enough of them.
    HWY_INLINE void refill(Packet& p) {
        if (std::popcount(kAllLanes & ~p.alive) >= kRefill) refillNow(p);
    }

private:
    void refillNow(Packet& p) {
        const D d;
        if (tail_ - head_ < kLanes && next_ < rays_.size()) {
            for (int n = 0; n < kQueued; ++n) hn::Store(hn::LoadU(d, queue_[n] + head_), d, queue_[n]);
            tail_ -= head_;
            head_ = 0;
            while (tail_ + kLanes <= kQueue && next_ < rays_.size()) enqueue();
        }
        if (head_ == tail_) return;
        unsigned idle = kAllLanes & ~p.alive;
        const auto table = tableIndices(kTable.rank[idle]);
        while (std::popcount(idle) > tail_ - head_) idle &= ~std::bit_floor(idle);
        const M taken = maskOf(idle);
        for (int n = 0; n < kQueued; ++n) {
            const V row = hn::LoadU(d, queue_[n] + head_);
            store(p, n, hn::IfThenElse(taken, hn::TableLookupLanes(row, table), load(p, n)));
        }
        store(p, kFace, hn::IfThenElse(taken, constant(-1), load(p, kFace)));
        p.alive |= idle;
        head_ += std::popcount(idle);
    }

    // Rays in cells: origin, direction and its inverse; a direction too small to invert is 0, its inverse infinite.
    struct LaneRays {
        V o[3], dir[3], inverse[3];
    };

    HWY_INLINE void toCells(const V in[8], LaneRays& lanes) const {
        const V infinity = constant(std::numeric_limits<double>::infinity());
        const V largest = constant(std::numeric_limits<double>::max());
        for (int axis = 0; axis < 3; ++axis) {
            const V mx = constant(map_.to_cells[0][axis]);
            const V my = constant(map_.to_cells[1][axis]);
            const V mz = constant(map_.to_cells[2][axis]);
            lanes.o[axis] = mx * in[0] + my * in[1] + mz * in[2] + constant(map_.origin[axis]);
            lanes.dir[axis] = mx * in[3] + my * in[4] + mz * in[5];
            lanes.inverse[axis] = constant(1) / lanes.dir[axis];
            const M finite = hn::Le(hn::Abs(lanes.inverse[axis]), largest);
            lanes.dir[axis] = hn::IfThenElseZero(finite, lanes.dir[axis]);
            lanes.inverse[axis] = hn::IfThenElse(finite, lanes.inverse[axis], infinity);
        }
    }

    // The part of the rays in the grid's box, and which rays have one.
    HWY_INLINE void clip(const LaneRays& lanes, V& start, V& end, M& good) const {
        const V zero = hn::Zero(D());
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
    }

    // Position, direction and cell at the start, mirrored so that every direction ascends.
    HWY_INLINE void placeInCells(const LaneRays& lanes, V start, V out[kQueued]) const {
        const D d;
        const V zero = hn::Zero(d);
        for (int axis = 0; axis < 3; ++axis) {
            const M still = hn::Eq(lanes.dir[axis], zero);
            const V at = lanes.o[axis] + start * lanes.dir[axis];
            const V within = hn::IfThenElse(still, hn::Min(at, constant(last_position_[axis])), at);
            const V sign = hn::And(lanes.dir[axis], constant(-0.0));
            const VI flip = hn::BroadcastSignBit(hn::BitCast(DI(), hn::IfThenZeroElse(still, sign)));
            const V back = hn::And(hn::BitCast(d, flip), constant(-0.0));
            out[kO + axis] = hn::Xor(within, back);
            out[kD + axis] = hn::Abs(lanes.dir[axis]);
            out[kInverse + axis] = hn::Abs(lanes.inverse[axis]);
            out[kFlip + axis] = hn::BitCast(d, flip);
            const VI size = whole(whole_size_[axis]);
            const VI least = hn::Neg(hn::And(flip, size));
            const VI cell = floorToWhole(out[kO + axis] + out[kT] * out[kD + axis]);
            out[kCell + axis] = hn::BitCast(d, hn::Min(hn::Max(cell, least), least + size - whole(1)));
        }
    }

    // Walk's constructor and Walk::enter() for the next rays, as many as there are lanes.
    void enqueue() {
        const D d;
        if (next_ == looked_at_) {
            const auto ahead = std::min(rays_.size() - next_, Beams::kMostRays);
            if constexpr (kBeams) starts_ = beams_.starts(rays_.subspan(next_, ahead));
            looked_from_ = next_;
            looked_at_ += ahead;
        }
        const double* starts = starts_.empty() ? nullptr : starts_.data() + (next_ - looked_from_);
        const auto left = looked_at_ - next_;
        if (starts != nullptr) {
            const auto some = std::min<std::size_t>(left, kLanes);
            if (std::none_of(starts, starts + some, [](double t) { return t < std::numeric_limits<double>::max(); })) {
                next_ += some;
                return;
            }
        }
        const auto count = std::min<std::size_t>(left, kLanes);
        const VI lane = hn::Iota(DI(), 0);
        const VI last = whole(static_cast<std::int64_t>(count) - 1);
        static_assert(sizeof(trace::Ray) == 8 * sizeof(double));
        const VI ray = hn::IfThenElse(hn::Gt(lane, last), last, lane);
        const VI row = hn::ShiftLeft<3>(ray);
        const double* base = &rays_[next_].origin.x;
        for (std::size_t n = next_ + kLanes; n < std::min(next_ + 2 * kLanes, rays_.size()); ++n)
            hwy::Prefetch(&rays_[n]);
        V in[8];
        for (int n = 0; n < 8; ++n) in[n] = hn::GatherIndex(d, base, row + whole(n));
        const V zero = hn::Zero(d);
        const V infinity = constant(std::numeric_limits<double>::infinity());
        LaneRays lanes;
        toCells(in, lanes);
        V start = in[6];
        V end = in[7];
        M good = hn::Not(toDouble(hn::Gt(lane, last)));
        clip(lanes, start, end, good);
        good = hn::And(good, hn::And(hn::Le(start, end), hn::Lt(hn::Abs(start), infinity)));
        V out[kQueued];
        out[kEnd] = end - start;
        out[kT] = zero;
        if (starts != nullptr) {
            // The skipped part is empty; starting in empty space changes neither the surface cells nor their entries.
            HWY_ALIGN double from[kLanes] = {};
            std::copy_n(starts, count, from);
            out[kT] = hn::Max(hn::Load(d, from) - start, zero);
            good = hn::And(good, hn::Lt(out[kT], out[kEnd]));
        }
        placeInCells(lanes, start, out);
        out[kStart] = start;
        out[kIndex] = toReal(lane + whole(static_cast<std::int64_t>(next_)));
        const unsigned kept = bitsOf(good);
        if (kept != kAllLanes) {
            const auto table = tableIndices(kTable.source[kept]);
            for (V& v : out) v = hn::TableLookupLanes(v, table);
        }
        for (int n = 0; n < kQueued; ++n) hn::StoreU(out[n], d, queue_[n] + tail_);
        tail_ += std::popcount(kept);
        next_ += count;
    }

    const CellMap& map_;
    const std::span<const trace::Ray> rays_;
    double size_[3];
    double last_position_[3];  // just below the box's far faces
    std::int64_t whole_size_[3];
    Beams beams_;
    std::span<const double> starts_;  // of the rays from looked_from_ to looked_at_, or none
    std::size_t looked_from_ = 0, looked_at_ = 0;
    std::size_t next_ = 0;     // the first ray that hasn't been queued
    int head_ = 0, tail_ = 0;  // of the queue
    HWY_ALIGN double queue_[kQueued][kQueue + 2 * kLanes];
};

}  // namespace HWY_NAMESPACE
}  // namespace stratum::march
HWY_AFTER_NAMESPACE();
#endif  // STRATUM_WIDE_LANES

#endif
