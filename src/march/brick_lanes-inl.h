// The walk of brick_walk.h in the lanes of a vector, for one Highway target at a time. Included by brick_stream.cpp
// alone, once a target: hence the guard that toggles.
//
// Rays wait in a queue, already clipped to the box. A packet holds as many rays as a vector has lanes; a lane whose ray
// ends takes the next from the queue. A turn of a packet either moves all lanes that are in empty space out of the
// largest empty blocks around them, or, once enough lanes stand in surface cells, solves those cells. Several packets
// take turns, so that one computes while the others wait for memory. All state lies in arrays in the first-level
// cache: there is more of it than registers.
#if defined(STRATUM_BRICK_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef STRATUM_BRICK_LANES_INL_H
#undef STRATUM_BRICK_LANES_INL_H
#else
#define STRATUM_BRICK_LANES_INL_H
#endif

#include "march/beam.h"
#include "march/brick_walk.h"
#include "march/cell_lanes-inl.h"
#include "march/hit_lanes-inl.h"
#include "march/intersector.h"
#include "march/lanes-inl.h"

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>

#if STRATUM_WIDE_LANES
HWY_BEFORE_NAMESPACE();
namespace stratum::march {
namespace HWY_NAMESPACE {

// Tried on three prints: more packets hide more of the memory's latency until their state fills the cache.
constexpr int kPackets = 6;
constexpr int kHold = kLanes * 3 / 8;  // lanes in surface cells that make a test worth its turn
constexpr int kRefill = kLanes / 4;    // lanes without a ray that make a visit to the queue worth it
constexpr int kQueue = 8 * kLanes;     // rays
/// What a lane keeps; one array each.
enum Field {
    kO,
    kD = kO + 3,
    kInverse = kD + 3,
    kCell = kInverse + 3,
    kEnd = kCell + 3,
    kStart,
    kIndex,
    kT,               // since the box was met
    kQueued,          // fields that a ray in the queue has
    kFace = kQueued,  // axis of the face that the cell was entered by, or -1
    kFields
};

struct Packet {
    HWY_ALIGN double field[kFields][kLanes];
    HWY_ALIGN std::int64_t sample[kLanes] = {};  // of a waiting lane: index of its cell's first corner
    unsigned alive = 0, waiting = 0;
};

template <bool kAny>
class Marcher {
public:
    Marcher(const BrickGrid& grid, const CellMap& map, std::span<const Ray> rays, Hit* hits, std::uint8_t* blocked)
        : grid_(grid),
          map_(map),
          rays_(rays),
          blocked_(blocked),
          late_(grid.late()),
          corners_(grid),
          batch_(corners_, map, rays, hits),
          beams_(grid, map) {
        for (int axis = 0; axis < 3; ++axis) size_[axis] = grid.size()[static_cast<std::size_t>(axis)];
        macro_y_ = size_[1] / BrickGrid::kMacroEdge;
        macro_z_ = size_[2] / BrickGrid::kMacroEdge;
        for (Packet& packet : packets_)
            // Lanes without a ray stand in cell 0 or where their last ray ended: what they read is there, and ignored.
            for (auto& field : packet.field)
                for (double& value : field) value = 0;
    }

    void run() {
        for (bool busy = true; busy;) {
            busy = false;
            for (Packet& packet : packets_) {
                if (std::popcount(kAllLanes & ~packet.alive) >= kRefill) refill(packet);
                if (packet.alive == 0) continue;
                busy = true;
                if (std::popcount(packet.waiting) >= kHold || packet.waiting == packet.alive)
                    solve(packet);
                else
                    leap(packet);
            }
        }
        if constexpr (!kAny) batch_.flush();
    }

private:
    static HWY_INLINE V load(const Packet& p, int field) { return hn::Load(D(), p.field[field]); }
    static HWY_INLINE void store(Packet& p, int field, V v) { hn::Store(v, D(), p.field[field]); }
    static HWY_INLINE VI gather(const void* base, VI index) {
        return hn::GatherIndex(DI(), static_cast<const std::int64_t*>(base), index);
    }

    // Walk's constructor and Walk::enter() for the next rays, as many as there are lanes.
    void enqueue() {
        const D d;
        if (next_ == looked_at_) {
            const auto ahead = std::min(rays_.size() - next_, Beams::kMostRays);
            if constexpr (!kAny) starts_ = beams_.starts(rays_.subspan(next_, ahead));
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
        static_assert(sizeof(Ray) == 8 * sizeof(double));
        const VI row = hn::ShiftLeft<3>(hn::IfThenElse(hn::Gt(lane, last), last, lane));
        const double* base = &rays_[next_].origin.x;
        for (std::size_t n = next_ + kLanes; n < std::min(next_ + 2 * kLanes, rays_.size()); ++n)
            hwy::Prefetch(&rays_[n]);
        V in[8];
        for (int n = 0; n < 8; ++n) in[n] = hn::GatherIndex(d, base, row + whole(n));
        const V zero = hn::Zero(d);
        const V infinity = constant(std::numeric_limits<double>::infinity());
        const V largest = constant(std::numeric_limits<double>::max());
        V o[3];
        V dir[3];
        V inverse[3];
        for (int axis = 0; axis < 3; ++axis) {
            const V mx = constant(map_.to_cells[0][axis]);
            const V my = constant(map_.to_cells[1][axis]);
            const V mz = constant(map_.to_cells[2][axis]);
            o[axis] = mx * in[0] + my * in[1] + mz * in[2] + constant(map_.origin[axis]);
            dir[axis] = mx * in[3] + my * in[4] + mz * in[5];
            inverse[axis] = constant(1) / dir[axis];
            const M finite = hn::Le(hn::Abs(inverse[axis]), largest);
            dir[axis] = hn::IfThenElseZero(finite, dir[axis]);
            inverse[axis] = hn::IfThenElseZero(finite, inverse[axis]);
        }
        V start = in[6];
        V end = in[7];
        M good = hn::Not(toDouble(hn::Gt(lane, last)));
        for (int axis = 0; axis < 3; ++axis) {
            const V extent = constant(size_[axis]);
            const M still = hn::Eq(dir[axis], zero);
            const M between = hn::And(hn::Ge(o[axis], zero), hn::Le(o[axis], extent));
            const V a = hn::Neg(o[axis]) * inverse[axis];
            const V b = (extent - o[axis]) * inverse[axis];
            const M swap = hn::Gt(a, b);
            const V near = hn::IfThenElse(swap, b, a);
            const V far = hn::IfThenElse(swap, a, b);
            good = hn::And(good, hn::Or(hn::And(still, between), hn::AndNot(still, hn::Le(near, far))));
            // std::max and std::min keep their first argument unless the second is beyond it.
            start = hn::IfThenElse(hn::AndNot(still, hn::Lt(start, near)), near, start);
            end = hn::IfThenElse(hn::AndNot(still, hn::Lt(far, end)), far, end);
        }
        good = hn::And(good, hn::And(hn::Le(start, end), hn::Lt(hn::Abs(start), infinity)));
        V out[kQueued];
        out[kEnd] = end - start;
        out[kT] = zero;
        if (starts != nullptr) {
            // What lies before is empty; a start in empty space changes no cell that matters, nor how it is entered.
            HWY_ALIGN double from[kLanes] = {};
            std::copy_n(starts, count, from);
            out[kT] = hn::Max(hn::Load(d, from) - start, zero);
            good = hn::And(good, hn::Lt(out[kT], out[kEnd]));
        }
        for (int axis = 0; axis < 3; ++axis) {
            out[kO + axis] = o[axis] + start * dir[axis];
            out[kD + axis] = dir[axis];
            out[kInverse + axis] = inverse[axis];
            out[kCell + axis] =
                clampTo(hn::Floor(out[kO + axis] + out[kT] * dir[axis]), zero, constant(size_[axis] - 1));
        }
        out[kStart] = start;
        out[kIndex] = fromWhole(lane + whole(static_cast<std::int64_t>(next_)));
        const unsigned kept = bitsOf(good);
        if (kept != kAllLanes) {
            const auto table = tableIndices(kTable.place[kept]);
            for (V& v : out) v = hn::TableLookupLanes(v, table);
        }
        for (int n = 0; n < kQueued; ++n) hn::StoreU(out[n], d, queue_[n] + tail_);
        tail_ += std::popcount(kept);
        next_ += count;
    }

    // Gives rays to the lanes that have none.
    void refill(Packet& p) {
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

    // Where a ray leaves a block, by the three planes ahead of it. Walk::aim().
    struct Exit {
        V t;
        M axis[3];
    };
    static HWY_INLINE Exit aim(const Packet& p, const V plane[3]) {
        const D d;
        const V zero = hn::Zero(d);
        const V infinity = constant(std::numeric_limits<double>::infinity());
        V t[3];
        for (int axis = 0; axis < 3; ++axis) {
            const M still = hn::Eq(load(p, kD + axis), zero);
            t[axis] = hn::IfThenElse(still, infinity, (plane[axis] - load(p, kO + axis)) * load(p, kInverse + axis));
        }
        const M y_first = hn::Lt(t[1], t[0]);
        const V t_xy = hn::Min(t[0], t[1]);
        const M z_first = hn::Lt(t[2], t_xy);
        Exit exit;
        exit.axis[0] = hn::Not(hn::Or(y_first, z_first));
        exit.axis[1] = hn::AndNot(z_first, y_first);
        exit.axis[2] = z_first;
        exit.t = hn::Max(hn::Min(t_xy, t[2]), load(p, kT));
        return exit;
    }

    // Moves the lanes of `moving` through their planes. Walk::advance(). Rays that end free their lanes.
    HWY_INLINE void advance(Packet& p, const V plane[3], const Exit& exit, M moving) {
        const D d;
        const V zero = hn::Zero(d);
        const V one = constant(1);
        M ended = hn::Ge(exit.t, load(p, kEnd));
        V next[3];
        for (int axis = 0; axis < 3; ++axis) {
            const V dir = load(p, kD + axis);
            const V cell = load(p, kCell + axis);
            const M forth = hn::Gt(dir, zero);
            const M still = hn::Eq(dir, zero);
            const V inner = hn::IfThenElse(forth, plane[axis] - one, plane[axis]);
            const V outer = hn::IfThenElse(forth, plane[axis], plane[axis] - one);
            const V there = hn::Floor(load(p, kO + axis) + exit.t * dir);
            const V along = clampTo(there, hn::IfThenElse(forth, cell, inner), hn::IfThenElse(forth, inner, cell));
            next[axis] = hn::IfThenElse(exit.axis[axis], outer, hn::IfThenElse(still, cell, along));
            ended = hn::Or(ended, hn::Or(hn::Lt(next[axis], zero), hn::Ge(next[axis], constant(size_[axis]))));
        }
        p.alive &= ~bitsOf(hn::And(ended, moving));
        moving = hn::AndNot(ended, moving);
        for (int axis = 0; axis < 3; ++axis)
            store(p, kCell + axis, hn::IfThenElse(moving, next[axis], load(p, kCell + axis)));
        store(p, kT, hn::IfThenElse(moving, exit.t, load(p, kT)));
        const V face = hn::IfThenElse(exit.axis[0], zero, hn::IfThenElse(exit.axis[1], one, constant(2)));
        store(p, kFace, hn::IfThenElse(moving, face, load(p, kFace)));
    }

    // One step of every lane that isn't waiting: out of the largest empty block, or to wait in a surface cell.
    void leap(Packet& p) {
        const D d;
        const DI di;
        const VI one = whole(1);
        const VI none = hn::Zero(di);
        const VI group = whole(0x330033);
        const VI c[3] = {toWhole(load(p, kCell)), toWhole(load(p, kCell + 1)), toWhole(load(p, kCell + 2))};
        const VI mx = hn::ShiftRight<5>(c[0]);
        const VI my = hn::ShiftRight<5>(c[1]);
        const VI mz = hn::ShiftRight<5>(c[2]);
        const VI macro = hn::ShiftLeft<1>(product(product(mx, whole(macro_y_)) + my, whole(macro_z_)) + mz);
        static_assert(sizeof(MacroCell) == 16);
        const VI bricks = gather(grid_.macroCells(), macro);
        const VI first = gather(grid_.macroCells(), macro + one);

        const VI b =
            hn::Or(hn::Or(hn::ShiftLeft<1>(hn::And(c[0], whole(24))), hn::ShiftRight<1>(hn::And(c[1], whole(24)))),
                   hn::ShiftRight<3>(hn::And(c[2], whole(24))));
        const auto has_brick = hn::TestBit(hn::BitCast(DU(), bricks), hn::BitCast(DU(), shiftedLeft(one, b)));
        const M in_brick = hn::RebindMask(d, has_brick);
        const auto group_empty = hn::Eq(hn::And(bricks, shiftedLeft(group, hn::And(b, whole(42)))), none);
        VI edge = hn::IfThenElse(group_empty, whole(16), whole(8));

        const VI before = hn::And(bricks, shiftedLeft(one, b) - one);
        const VI rank = hn::BitCast(di, hn::PopulationCount(hn::BitCast(DU(), before)));
        // Lanes without a brick read the first one's mask and ignore it.
        const VI brick = hn::IfThenElseZero(hn::RebindMask(di, in_brick), hn::And(first, whole(0xffffffff)) + rank);
        const VI half = hn::Or(hn::Or(hn::And(c[0], whole(4)), hn::ShiftRight<1>(hn::And(c[1], whole(4)))),
                               hn::ShiftRight<2>(hn::And(c[2], whole(4))));
        const VI part = hn::ShiftLeft<3>(brick) + half;
        const VI cells = hn::Not(gather(grid_.clearCells(), part));
        const VI three = whole(3);
        const VI at = hn::Or(hn::Or(hn::ShiftLeft<4>(hn::And(c[0], three)), hn::ShiftLeft<2>(hn::And(c[1], three))),
                             hn::And(c[2], three));
        const auto cell_set = hn::TestBit(cells, shiftedLeft(one, at));
        const auto cells_empty = hn::Eq(hn::And(cells, shiftedLeft(group, hn::And(at, whole(42)))), none);
        const VI small = hn::IfThenElse(cells_empty, hn::IfThenElse(hn::Eq(cells, none), whole(4), whole(2)), one);
        edge = hn::IfThenElse(hn::RebindMask(di, in_brick), small, edge);
        const M surface = hn::And(in_brick, toDouble(cell_set));

        const M walking = maskOf(p.alive & ~p.waiting);
        V plane[3];
        for (int axis = 0; axis < 3; ++axis) {
            const M forth = hn::Gt(load(p, kD + axis), hn::Zero(d));
            const VI low = hn::AndNot(edge - one, c[axis]);
            plane[axis] = fromWhole(low + hn::IfThenElseZero(hn::RebindMask(di, forth), edge));
        }
        const M far = hn::And(walking, toDouble(hn::Eq(bricks, none)));
        if (!hn::AllFalse(d, far)) {
            const V radius = fromWhole(hn::BitCast(di, hn::ShiftRight<32>(hn::BitCast(DU(), first))));
            const V m[3] = {fromWhole(mx), fromWhole(my), fromWhole(mz)};
            const V macro_edge = constant(BrickGrid::kMacroEdge);
            for (int axis = 0; axis < 3; ++axis) {
                const M forth = hn::Gt(load(p, kD + axis), hn::Zero(d));
                const V high = hn::Min((m[axis] + radius) * macro_edge, constant(size_[axis]));
                const V low = hn::Max((m[axis] - (radius - constant(1))) * macro_edge, hn::Zero(d));
                plane[axis] = hn::IfThenElse(far, hn::IfThenElse(forth, high, low), plane[axis]);
            }
        }
        const unsigned found = bitsOf(hn::And(surface, walking));
        if (found != 0) hold(p, found, brick, part, at, c);
        if (p.waiting != p.alive) advance(p, plane, aim(p, plane), hn::AndNot(surface, walking));
    }

    static HWY_INLINE VI shiftedLeft(VI v, VI count) {
        return hn::BitCast(DI(), hn::BitCast(DU(), v) << hn::BitCast(DU(), count));
    }

    // Remembers where the corners of surface cells lie, and calls for them. Lanes whose brick had to be laid out first
    // look again in their next turn.
    HWY_INLINE void hold(Packet& p, unsigned found, VI brick, VI part, VI at, const VI c[3]) {
        const VI slot = hn::And(
            hn::GatherOffset(DI(), reinterpret_cast<const std::int64_t*>(grid_.slots()), hn::ShiftLeft<2>(brick)),
            whole(0xffffffff));
        if (late_) {
            found = thereOf(found, slot, brick, part, at, c);
            if (found == 0) return;
        }
        const VI seven = whole(7);
        const VI sample = product(slot - whole(1), whole(BrickGrid::kBrickSamples)) +
                          product(hn::And(c[0], seven), whole(BrickGrid::kStrideX)) +
                          product(hn::And(c[1], seven), whole(BrickGrid::kStrideY)) + hn::And(c[2], seven);
        const auto newly = hn::RebindMask(DI(), maskOf(found));
        hn::Store(hn::IfThenElse(newly, sample, hn::Load(DI(), p.sample)), DI(), p.sample);
        p.waiting |= found;
        for (unsigned rest = found; rest != 0; rest &= rest - 1) corners_.prefetch(p.sample[std::countr_zero(rest)]);
    }

    // Which of the lanes stand in surface cells of bricks that are laid out; asks for the others' bricks.
    HWY_NOINLINE unsigned thereOf(unsigned found, VI slot, VI brick, VI part, VI at, const VI c[3]) const {
        const unsigned not_there = bitsOf(toDouble(hn::Eq(slot, hn::Zero(DI())))) & found;
        if (not_there != 0) require(not_there, brick, c);
        // The bits may be older than the slot: laid out by another thread in between.
        std::atomic_signal_fence(std::memory_order_acquire);
        const VI clear = gather(grid_.clearCells(), part);
        return found & ~not_there & ~bitsOf(toDouble(hn::TestBit(clear, shiftedLeft(whole(1), at))));
    }

    HWY_NOINLINE void require(unsigned lanes, VI brick, const VI c[3]) const {
        HWY_ALIGN std::int64_t bricks[kLanes];
        HWY_ALIGN std::int64_t place[3][kLanes];
        hn::Store(brick, DI(), bricks);
        for (int axis = 0; axis < 3; ++axis) hn::Store(hn::ShiftRight<3>(c[axis]), DI(), place[axis]);
        for (unsigned rest = lanes; rest != 0; rest &= rest - 1) {
            const int lane = std::countr_zero(rest);
            grid_.require(static_cast<std::size_t>(bricks[lane]), static_cast<int>(place[0][lane]),
                          static_cast<int>(place[1][lane]), static_cast<int>(place[2][lane]));
        }
    }

    // SegmentCubic and firstCrossing() for the waiting lanes. Those that don't hit walk on.
    void solve(Packet& p) {
        const D d;
        const V zero = hn::Zero(d);
        const V one = constant(1);
        const M waiting = maskOf(p.waiting);
        V plane[3];
        M forth[3];
        V cell[3];
        for (int axis = 0; axis < 3; ++axis) {
            forth[axis] = hn::Gt(load(p, kD + axis), zero);
            cell[axis] = load(p, kCell + axis);
            plane[axis] = cell[axis] + hn::IfThenElseZero(forth[axis], one);
        }
        const Exit exit = aim(p, plane);
        const V t = load(p, kT);
        const V t_out = hn::Min(exit.t, load(p, kEnd));
        const M whole_cell = hn::Le(exit.t, load(p, kEnd));
        const V face = load(p, kFace);
        LaneCell in;
        for (int axis = 0; axis < 3; ++axis) {
            const V o = load(p, kO + axis);
            const V dir = load(p, kD + axis);
            const V enter = clampTo(o + t * dir - cell[axis], zero, one);
            const V leave = clampTo(o + t_out * dir - cell[axis], zero, one);
            const M by_this = hn::Eq(face, constant(axis));
            in.from.v[axis] = hn::IfThenElse(by_this, hn::IfThenElse(forth[axis], zero, one), enter);
            in.to.v[axis] =
                hn::IfThenElse(hn::And(whole_cell, exit.axis[axis]), hn::IfThenElse(forth[axis], one, zero), leave);
        }
        // Lanes that don't wait read where they last stood, or the first sample, and are ignored.
        const VI sample = hn::Load(DI(), p.sample);
        corners_.read(sample, in.v);
        const LaneCubic f = cubicOf(in);
        const M in0 = hn::Lt(f.c0, zero);
        const M in1 = hn::Lt(f.c0 + f.c1 / constant(3), zero);
        const M in2 = hn::Lt(f.c0 + (constant(2) * f.c1 + f.c2) / constant(3), zero);
        const M in3 = hn::Lt(f.end, zero);
        const M differ = hn::Xor(in0, in3);
        const M between = hn::Or(hn::Xor(in0, in1), hn::Xor(in1, in2));
        // Signs that change once, or more than once.
        const M twice =
            hn::And(waiting, hn::Or(hn::AndNot(differ, hn::Or(between, hn::Xor(in2, in3))),
                                    hn::And(hn::Xor(in0, in1), hn::And(hn::Xor(in1, in2), hn::Xor(in2, in3)))));
        unsigned hit = bitsOf(hn::And(hn::AndNot(twice, differ), waiting));
        const unsigned rare = bitsOf(twice);
        V s = constant(std::numeric_limits<double>::quiet_NaN());
        if (rare != 0) hit |= solveOneByOne<kAny>(rare, in, s);
        p.waiting = 0;
        if (hit != 0) {
            if constexpr (kAny)
                for (unsigned rest = hit; rest != 0; rest &= rest - 1)
                    blocked_[static_cast<std::size_t>(p.field[kIndex][std::countr_zero(rest)])] = 1;
            else
                batch_.push(hit, {load(p, kIndex), load(p, kStart), t, t_out, s}, in, sample);
            p.alive &= ~hit;
        }
        advance(p, plane, exit, hn::AndNot(maskOf(hit), waiting));
    }

    const BrickGrid& grid_;
    const CellMap& map_;
    const std::span<const Ray> rays_;
    std::uint8_t* const blocked_;
    double size_[3];
    std::int64_t macro_y_, macro_z_;
    const bool late_;
    const CornerReader corners_;
    HitBatch batch_;
    Beams beams_;
    std::span<const double> starts_;  // of the rays from looked_from_ to looked_at_, or none
    std::size_t looked_from_ = 0, looked_at_ = 0;
    std::size_t next_ = 0;     // the first ray that hasn't been queued
    int head_ = 0, tail_ = 0;  // of the queue
    HWY_ALIGN double queue_[kQueued][kQueue + 2 * kLanes];
    HWY_ALIGN Packet packets_[kPackets];
};

}  // namespace HWY_NAMESPACE
}  // namespace stratum::march
HWY_AFTER_NAMESPACE();
#endif  // STRATUM_WIDE_LANES

#endif
