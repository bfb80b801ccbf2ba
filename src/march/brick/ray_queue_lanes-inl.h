// The queue that feeds rays into the lanes of packets, for one Highway target at a time, hence the guard that toggles.
//
// Rays wait in a queue, already clipped to the box. A packet holds as many rays as a vector has lanes; a lane whose ray
// ends takes the next from the queue. Rays from one eye begin where their beam meets the first block with surface
// (FanRays); those whose beam meets none never wait.
#if defined(STRATUM_RAY_QUEUE_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef STRATUM_RAY_QUEUE_LANES_INL_H
#undef STRATUM_RAY_QUEUE_LANES_INL_H
#else
#define STRATUM_RAY_QUEUE_LANES_INL_H
#endif

#include "march/brick/beam.h"
#include "march/brick/lanes-inl.h"
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

class FanRays {
public:
    /// The most rays of one call.
    static constexpr std::size_t kMost = 4096;

    FanRays(const BrickGrid& grid, const CellMap& map, const RayBox& box) : map_(map), box_(box), beams_(grid) {}

    /// Keeps those of the rays whose beams come to a block with surface. False if they have not one origin or no axis
    /// along which they all move, or are too few.
    bool begin(std::span<const trace::Ray> rays) {
        kept_ = next_ = 0;
        if (rays.size() < kFewRays || rays.size() > kMost || !mayHaveOneOrigin(rays)) return false;
        fan_.eye = map_.to_cells * rays[0].origin + map_.origin;
        const glm::dvec3 ahead = map_.to_cells * rays[rays.size() / 2].direction;
        fan_.main = 0;
        for (int axis = 1; axis < 3; ++axis)
            if (std::abs(ahead[axis]) > std::abs(ahead[fan_.main])) fan_.main = axis;
        fan_.forth = ahead[fan_.main] > 0;
        if (!std::isfinite(fan_.eye.x + fan_.eye.y + fan_.eye.z) || !place(rays)) return false;
        beams_.begin(fan_, rays.size());
        sort(rays.size());
        beams_.findPlanes();
        keep(rays.size());
        return true;
    }

    std::size_t left() const { return kept_ - next_; }
    /// The next rays, as many as lanes have, where they come to their first block: all fields of the queue. kIndex:
    /// their places among all of begin(). Returns which come there.
    HWY_INLINE M next(V out[kQueued]) {
        const D d;
        const V zero = hn::Zero(d);
        LaneRays lanes;
        for (int axis = 0; axis < 3; ++axis) {
            lanes.o[axis] = constant(fan_.eye[axis]);
            lanes.dir[axis] = hn::LoadU(d, direction_[axis] + next_);
        }
        box_.invert(lanes);
        V start = hn::LoadU(d, t_min_ + next_);
        V end = hn::LoadU(d, t_max_ + next_);
        const VI left = whole(static_cast<std::int64_t>(kept_ - next_));
        const M good = hn::And(box_.clip(lanes, start, end), toDouble(hn::Lt(hn::Iota(DI(), 0), left)));
        box_.mirror(lanes, start, out);
        out[kEnd] = end - start;
        out[kStart] = start;
        out[kIndex] = hn::LoadU(d, index_ + next_);
        const M there = moveTo(hn::LoadU(d, plane_ + next_), out);
        next_ = std::min<std::size_t>(next_ + kLanes, kept_);
        return hn::And(good, there);
    }

private:
    static constexpr std::size_t kFewRays = 64;  // for fewer, beams cost more than they save
    static constexpr std::size_t kAhead = 64;    // rays that are fetched before they are placed
    static constexpr double kSteepest = 8;       // slope; rays that differ more have no axis in common

    // A look at three of them; place() looks at all.
    static bool mayHaveOneOrigin(std::span<const trace::Ray> rays) {
        return rays[1].origin == rays[0].origin && rays[rays.size() / 2].origin == rays[0].origin;
    }

    // Directions in cells, and slopes. False if not all rays have the first one's origin and a common axis.
    bool place(std::span<const trace::Ray> rays) {
        const D d;
        const V infinity = constant(std::numeric_limits<double>::infinity());
        const V zero = hn::Zero(d);
        const V sign = constant(fan_.forth ? 1 : -1);
        V low[2] = {infinity, infinity};
        V high[2] = {hn::Neg(infinity), hn::Neg(infinity)};
        M common = hn::Eq(zero, zero);
        for (std::size_t first = 0; first < rays.size(); first += kLanes) {
            for (std::size_t n = first + kAhead; n < std::min(first + kAhead + kLanes, rays.size()); ++n)
                hwy::Prefetch(&rays[n]);
            V in[8];
            loadRays(&rays[first], static_cast<int>(std::min<std::size_t>(rays.size() - first, kLanes)), in);
            V direction[3];
            for (int axis = 0; axis < 3; ++axis) {
                common = hn::And(common, hn::Eq(in[axis], constant(rays[0].origin[axis])));
                direction[axis] = box_.across(axis, in + 3);
                hn::Store(direction[axis], d, direction_[axis] + first);
            }
            const V ahead = direction[fan_.main] * sign;
            const V way = constant(1) / ahead;
            common = hn::And(common, hn::And(hn::Gt(ahead, zero), hn::Lt(way, infinity)));
            for (int k = 0; k < 2; ++k) {
                const V slope = direction[(fan_.main + 1 + k) % 3] * way;
                common = hn::And(common, hn::Lt(hn::Abs(slope), constant(kSteepest)));
                low[k] = hn::Min(low[k], slope);
                high[k] = hn::Max(high[k], slope);
                hn::Store(slope, d, slope_[k] + first);
            }
            hn::Store(in[6], d, t_min_ + first);
            hn::Store(in[7], d, t_max_ + first);
        }
        if (!hn::AllTrue(d, common)) return false;
        for (int k = 0; k < 2; ++k) {
            fan_.low[k] = hn::GetLane(hn::MinOfLanes(d, low[k]));
            fan_.high[k] = hn::GetLane(hn::MaxOfLanes(d, high[k]));
        }
        return true;
    }

    // Into beams.
    void sort(std::size_t count) {
        const D d;
        V low[2];
        V scale[2];
        for (int k = 0; k < 2; ++k) {
            low[k] = constant(fan_.low[k]);
            scale[k] = constant(beams_.scale(k));
        }
        for (std::size_t first = 0; first < count; first += kLanes) {
            const VI column = floorToWhole((hn::Load(d, slope_[0] + first) - low[0]) * scale[0]);
            const VI row = floorToWhole((hn::Load(d, slope_[1] + first) - low[1]) * scale[1]);
            hn::Store(hn::ShiftLeft<5>(row) + column, DI(), beam_ + first);
        }
        static_assert(Beams::kMostSide == 1 << 5);
        for (std::size_t n = 0; n < count; ++n) beams_.open(static_cast<std::size_t>(beam_[n]));
    }

    // Moves the rays that are kept to the front.
    void keep(std::size_t count) {
        const D d;
        const V infinity = constant(std::numeric_limits<double>::infinity());
        for (std::size_t first = 0; first < count; first += kLanes) {
            const V plane = hn::GatherIndex(d, beams_.planes(), hn::Load(DI(), beam_ + first));
            const VI index = hn::Iota(DI(), static_cast<std::int64_t>(first));
            const unsigned kept = bitsOf(
                hn::And(hn::Lt(plane, infinity), toDouble(hn::Lt(index, whole(static_cast<std::int64_t>(count))))));
            if (kept == 0) continue;
            const auto table = tableIndices(kTable.source[kept]);
            const auto pack = [&](V row, double* to)
                                  HWY_ATTR { hn::StoreU(hn::TableLookupLanes(row, table), d, to + kept_); };
            for (double* const row : {direction_[0], direction_[1], direction_[2], t_min_, t_max_})
                pack(hn::Load(d, row + first), row);
            pack(plane, plane_);
            pack(toReal(index), index_);
            kept_ += static_cast<std::size_t>(std::popcount(kept));
        }
    }

    // To a plane across the main axis, before which a ray meets no surface: t, face and cell there. False if the ray
    // ends before.
    HWY_INLINE M moveTo(V plane, V out[kQueued]) const {
        const D d;
        const V zero = hn::Zero(d);
        const int main = fan_.main;
        const V t = (plane - out[kO + main]) * out[kInverse + main];
        out[kT] = t;
        // A walk to the plane would come through this cell's face on it if the planes of the cell's other faces are met
        // before and after, rounding included. Then its t is this one.
        M entered = hn::Gt(t, zero);
        for (int axis = 0; axis < 3; ++axis) {
            if (axis == main) continue;
            const V low = toReal(box_.cellAt(axis, out));
            const V before = (low - out[kO + axis]) * out[kInverse + axis];
            const V after = (low + constant(1) - out[kO + axis]) * out[kInverse + axis];
            entered = hn::And(entered, hn::And(hn::Lt(before, t), hn::Gt(after, t)));
        }
        // Other rays begin a little before, in empty space, as if they had come from there.
        const V early = hn::Max((plane - constant(kBefore) - out[kO + main]) * out[kInverse + main], zero);
        out[kT] = hn::IfThenElse(entered, t, early);
        out[kFace] = hn::IfThenElse(entered, constant(main), constant(-1));
        for (int axis = 0; axis < 3; ++axis) out[kCell + axis] = hn::BitCast(d, box_.cellAt(axis, out));
        out[kCell + main] = hn::IfThenElse(entered, hn::BitCast(d, floorToWhole(plane)), out[kCell + main]);
        return hn::Lt(out[kT], out[kEnd]);
    }

    static constexpr double kBefore = 0x1p-6;  // cells
    static constexpr std::size_t kRoom = kMost + kLanes;

    const CellMap& map_;
    const RayBox& box_;
    RayFan fan_;
    Beams beams_;
    std::size_t kept_ = 0, next_ = 0;
    HWY_ALIGN double direction_[3][kRoom];
    HWY_ALIGN double slope_[2][kRoom];
    HWY_ALIGN double t_min_[kRoom], t_max_[kRoom], plane_[kRoom], index_[kRoom];
    HWY_ALIGN std::int64_t beam_[kRoom];
};

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
