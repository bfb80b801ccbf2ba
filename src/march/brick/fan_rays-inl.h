// Rays from one eye that may meet surface, and where they begin: for one Highway target at a time, hence the guard that
// toggles.
#if defined(STRATUM_FAN_RAYS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef STRATUM_FAN_RAYS_INL_H
#undef STRATUM_FAN_RAYS_INL_H
#else
#define STRATUM_FAN_RAYS_INL_H
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

#if STRATUM_WIDE_LANES
HWY_BEFORE_NAMESPACE();
namespace stratum::march {
namespace HWY_NAMESPACE {

class FanRays {
public:
    /// The most rays of one call.
    static constexpr std::size_t kMost = 4096;

    FanRays(const BrickGrid& grid, const CellMap& map, const RayBox& box) : map_(map), box_(box), beams_(grid) {}

    /// Keeps those of the rays that come to a block with surface. False if they have not one origin or no axis along
    /// which they all move, or are too few.
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
        beams_.findDepths();
        keep(rays.size());
        return true;
    }

    std::size_t left() const { return kept_ - next_; }
    /// The next rays, as many as lanes have; if they are fewer, the first lanes. `from`: where they begin, from their
    /// start on. `index`: their places among all of begin().
    struct Next {
        LaneRays rays;
        V start, length, from, index;
    };
    HWY_INLINE Next next() {
        const D d;
        Next n;
        for (int axis = 0; axis < 3; ++axis) {
            n.rays.o[axis] = constant(fan_.eye[axis]);
            n.rays.dir[axis] = hn::LoadU(d, direction_[axis] + next_);
            n.rays.inverse[axis] = inverseOf(n.rays.dir[axis]);
        }
        n.start = hn::LoadU(d, start_ + next_);
        n.length = hn::LoadU(d, length_ + next_);
        n.from = hn::LoadU(d, from_ + next_);
        n.index = hn::LoadU(d, index_ + next_);
        next_ = std::min<std::size_t>(next_ + kLanes, kept_);
        return n;
    }

private:
    static constexpr std::size_t kFewRays = 64;  // for fewer, beams cost more than they save
    static constexpr std::size_t kAhead = 64;    // rays that are fetched before they are placed
    static constexpr double kSteepest = 8;       // slope; rays that differ more have no axis in common

    // A look at three of them; place() looks at all.
    static bool mayHaveOneOrigin(std::span<const trace::Ray> rays) {
        return rays[1].origin == rays[0].origin && rays[rays.size() / 2].origin == rays[0].origin;
    }

    // Directions in cells, the rays' parts in the grid's box, and slopes. False if not all rays have the first one's
    // origin and a common axis.
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
            LaneRays lanes;
            for (int axis = 0; axis < 3; ++axis) {
                lanes.o[axis] = constant(fan_.eye[axis]);
                common = hn::And(common, hn::Eq(in[axis], constant(rays[0].origin[axis])));
            }
            box_.turn(in + 3, lanes);
            V start = in[6];
            V end = in[7];
            const M good = box_.clip(lanes, start, end);
            const V way = hn::Abs(lanes.inverse[fan_.main]);
            common = hn::And(common, hn::And(hn::Gt(lanes.dir[fan_.main] * sign, zero), hn::Lt(way, infinity)));
            for (int k = 0; k < 2; ++k) {
                const V slope = lanes.dir[(fan_.main + 1 + k) % 3] * way;
                common = hn::And(common, hn::Lt(hn::Abs(slope), constant(kSteepest)));
                low[k] = hn::Min(low[k], slope);
                high[k] = hn::Max(high[k], slope);
                hn::Store(slope, d, slope_[k] + first);
            }
            for (int axis = 0; axis < 3; ++axis) hn::Store(lanes.dir[axis], d, direction_[axis] + first);
            hn::Store(start, d, start_ + first);
            // Rays without a part get a negative length.
            hn::Store(hn::IfThenElse(good, end - start, constant(-1)), d, length_ + first);
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
        for (std::size_t n = 0; n < count; ++n)
            if (length_[n] >= 0)
                beams_.open(static_cast<int>(beam_[n] % Beams::kMostSide),
                            static_cast<int>(beam_[n] / Beams::kMostSide));
    }

    // Moves the rays that are kept to the front.
    void keep(std::size_t count) {
        const D d;
        const V zero = hn::Zero(d);
        for (std::size_t first = 0; first < count; first += kLanes) {
            const V length = hn::Load(d, length_ + first);
            const V depth = hn::GatherIndex(d, beams_.depths(), hn::Load(DI(), beam_ + first));
            V row[kRows];
            for (int axis = 0; axis < 3; ++axis) row[axis] = hn::Load(d, direction_[axis] + first);
            const V start = hn::Load(d, start_ + first);
            const V from = hn::Max(depth * hn::Abs(inverseOf(row[fan_.main])) - start, zero);
            const VI index = hn::Iota(DI(), static_cast<std::int64_t>(first));
            M good = hn::And(hn::Ge(length, zero), hn::Lt(from, length));
            good = hn::And(good, toDouble(hn::Lt(index, whole(static_cast<std::int64_t>(count)))));
            const unsigned kept = bitsOf(good);
            if (kept == 0) continue;
            row[3] = start;
            row[4] = length;
            row[5] = from;
            row[6] = toReal(index);
            const auto table = tableIndices(kTable.source[kept]);
            double* const to[kRows] = {direction_[0], direction_[1], direction_[2], start_, length_, from_, index_};
            for (int n = 0; n < kRows; ++n) hn::StoreU(hn::TableLookupLanes(row[n], table), d, to[n] + kept_);
            kept_ += static_cast<std::size_t>(std::popcount(kept));
        }
    }

    static constexpr int kRows = 7;
    static constexpr std::size_t kRoom = kMost + kLanes;

    const CellMap& map_;
    const RayBox& box_;
    RayFan fan_;
    Beams beams_;
    std::size_t kept_ = 0, next_ = 0;
    HWY_ALIGN double direction_[3][kRoom];
    HWY_ALIGN double slope_[2][kRoom];
    HWY_ALIGN double start_[kRoom], length_[kRoom], from_[kRoom], index_[kRoom];
    HWY_ALIGN std::int64_t beam_[kRoom];
};

}  // namespace HWY_NAMESPACE
}  // namespace stratum::march
HWY_AFTER_NAMESPACE();
#endif  // STRATUM_WIDE_LANES

#endif
