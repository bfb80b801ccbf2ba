// The queue that feeds rays into the lanes of packets, for one Highway target at a time, hence the guard that toggles.
//
// Rays wait in a queue, already clipped to the box. A packet holds as many rays as a vector has lanes; a lane whose ray
// ends takes the next from the queue.
#if defined(STRATUM_RAY_QUEUE_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef STRATUM_RAY_QUEUE_LANES_INL_H
#undef STRATUM_RAY_QUEUE_LANES_INL_H
#else
#define STRATUM_RAY_QUEUE_LANES_INL_H
#endif

#include "march/brick/fan_rays-inl.h"
#include "march/brick/packet_lanes-inl.h"
#include "trace/intersector.h"

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>

#if STRATUM_WIDE_LANES
HWY_BEFORE_NAMESPACE();
namespace stratum::march {
namespace HWY_NAMESPACE {

constexpr int kRefill = kLanes / 4;  // lanes without a ray that make a refill worthwhile
constexpr int kQueue = 4 * kLanes;   // rays

/// Instead of FanRays where no ray comes from an eye.
struct NoFan {
    NoFan(const BrickGrid& /*grid*/, const CellMap& /*map*/, const RayBox& /*box*/) {}
    static constexpr std::size_t left() { return 0; }
};

/// With kFans, for rays that may come from one eye.
template <bool kFans>
class RayQueue {
public:
    RayQueue(const BrickGrid& grid, const CellMap& map, const MacroTable& macros, std::span<const trace::Ray> rays)
        : box_(grid, map), macros_(macros), rays_(rays), fan_(grid, map, box_) {}

    /// Gives rays to the lanes that have none, once there are enough of them.
    HWY_INLINE void refill(Packet& p) {
        if (std::popcount(kAllLanes & ~p.alive) >= kRefill) refillNow(p);
    }

    /// Whether the last rays that were queued came from one eye.
    bool isFan() const { return is_fan_; }

private:
    void refillNow(Packet& p) {
        const D d;
        if (tail_ - head_ < kLanes && anyLeft()) {
            for (int n = 0; n < kQueued; ++n) hn::Store(hn::LoadU(d, queue_[n] + head_), d, queue_[n]);
            tail_ -= head_;
            head_ = 0;
            while (tail_ + kLanes <= kQueue && anyLeft()) enqueue();
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
        p.alive |= idle;
        head_ += std::popcount(idle);
    }

    bool anyLeft() const { return next_ < rays_.size() || fan_.left() > 0; }

    // Walk's constructor and Walk::enter() for the next rays, as many as there are lanes.
    void enqueue() {
        if constexpr (kFans) {
            if (next_ == tried_ && fan_.left() == 0) tryFan();
            is_fan_ = fan_.left() > 0;
            if (is_fan_) return enqueueFan();
            if (next_ == tried_) return;
        }
        const D d;
        const auto count = std::min<std::size_t>((kFans ? tried_ : rays_.size()) - next_, kLanes);
        const VI lane = hn::Iota(DI(), 0);
        const VI last = whole(static_cast<std::int64_t>(count) - 1);
        for (std::size_t n = next_ + kLanes; n < std::min(next_ + 2 * kLanes, rays_.size()); ++n)
            hwy::Prefetch(&rays_[n]);
        V in[8];
        loadRays(&rays_[next_], static_cast<int>(count), in);
        LaneRays lanes;
        box_.toCells(in, lanes);
        V start = in[6];
        V end = in[7];
        const M good = hn::AndNot(toDouble(hn::Gt(lane, last)), box_.clip(lanes, start, end));
        V out[kQueued];
        box_.mirror(lanes, start, out);
        out[kEnd] = end - start;
        out[kT] = hn::Zero(d);
        out[kStart] = start;
        out[kIndex] = toReal(lane + whole(static_cast<std::int64_t>(next_)));
        out[kFace] = constant(-1);
        for (int axis = 0; axis < 3; ++axis) out[kCell + axis] = hn::BitCast(d, box_.cellAt(axis, out));
        next_ += count;
        append(out, good);
    }
    // The next rays, as many as can be, form a fan or are queued one by one.
    void tryFan() {
        const std::size_t ahead = std::min(rays_.size() - next_, FanRays::kMost);
        tried_ += ahead;
        if (!fan_.begin(rays_.subspan(next_, ahead))) return;
        fan_from_ = next_;
        next_ = tried_;
    }
    void enqueueFan() {
        V out[kQueued];
        const M good = fan_.next(out);
        out[kIndex] = out[kIndex] + constant(static_cast<double>(fan_from_));
        append(out, good);
    }
    // Those of the rays that are good.
    HWY_INLINE void append(V out[kQueued], M good) {
        VI cell[3];
        for (int axis = 0; axis < 3; ++axis)
            cell[axis] = hn::BitCast(DI(), hn::Xor(out[kCell + axis], out[kFlip + axis]));
        out[kMacro] = hn::BitCast(D(), macros_.at(cell));
        const unsigned kept = bitsOf(good);
        if (kept != kAllLanes) {
            const auto table = tableIndices(kTable.source[kept]);
            for (int n = 0; n < kQueued; ++n) out[n] = hn::TableLookupLanes(out[n], table);
        }
        for (int n = 0; n < kQueued; ++n) hn::StoreU(out[n], D(), queue_[n] + tail_);
        tail_ += std::popcount(kept);
    }

    const RayBox box_;
    const MacroTable& macros_;
    const std::span<const trace::Ray> rays_;
    std::size_t next_ = 0;  // the first ray that hasn't been queued, nor given to fan_
    std::conditional_t<kFans, FanRays, NoFan> fan_;
    std::size_t tried_ = 0, fan_from_ = 0;  // rays before the first were tried as a fan; the fan's first one
    bool is_fan_ = false;
    int head_ = 0, tail_ = 0;  // of the queue
    HWY_ALIGN double queue_[kQueued][kQueue + 2 * kLanes];
};

}  // namespace HWY_NAMESPACE
}  // namespace stratum::march
HWY_AFTER_NAMESPACE();
#endif  // STRATUM_WIDE_LANES

#endif
