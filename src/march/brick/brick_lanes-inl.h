// The walk of brick_walk.h in the lanes of a vector, for one Highway target at a time. Included by brick_stream.cpp
// alone, once a target: hence the guard that toggles.
//
// A step of a packet of rays either moves all lanes in empty space out of the largest empty blocks around them, or,
// once enough lanes are in surface cells, solves those cells. Then it looks up the lanes' new cells and prefetches the
// memory that its next step reads; meanwhile other packets do their steps. What the look-up itself reads, macro cells,
// is prefetched by the step before, where there are many. All state is in arrays in the first-level cache: there is
// more of it than registers.
#if defined(STRATUM_BRICK_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef STRATUM_BRICK_LANES_INL_H
#undef STRATUM_BRICK_LANES_INL_H
#else
#define STRATUM_BRICK_LANES_INL_H
#endif

#include "march/brick/brick_walk.h"
#include "march/brick/cell_lanes-inl.h"
#include "march/brick/lanes-inl.h"
#include "march/brick/macro_cell.h"
#include "march/brick/packet_lanes-inl.h"
#include "march/brick/ray_queue_lanes-inl.h"
#include "trace/intersector.h"

#include <hwy/highway.h>

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#if STRATUM_WIDE_LANES
HWY_BEFORE_NAMESPACE();
namespace stratum::march {
namespace HWY_NAMESPACE {

// Mask64 of macro_cell.h in lanes.

/// A position in a Mask64, of whose coordinates only the low two bits count.
struct MaskPosition {
    VI v[3];

    /// Mask64::bit().
    HWY_INLINE VI bit() const {
        const VI three = whole(3);
        return hn::Or(hn::Or(hn::ShiftLeft<4>(hn::And(v[0], three)), hn::ShiftLeft<2>(hn::And(v[1], three))),
                      hn::And(v[2], three));
    }
};

/// Mask64::group() around a bit.
HWY_INLINE VI groupAround(VI bit) {
    return shiftedLeft(whole(static_cast<std::int64_t>(Mask64::group(0, 0, 0))), hn::And(bit, whole(42)));
}

/// Those of the bits of `mask` that a ray can come to from a position, it included: kAhead. `flip`: -1 along axes along
/// which the direction descends, else 0.
HWY_INLINE VI aheadIn(VI mask, const MaskPosition& from, const VI flip[3]) {
#if HWY_TARGET == HWY_AVX2
    VI index = from.bit();
    for (int axis = 0; axis < 3; ++axis) index = hn::Or(index, hn::And(flip[axis], whole(256 >> axis)));
    return hn::And(mask, gather(kAhead.data(), index));
#else
    // The product of three tables of eight entries, each of which fits in a vector: a gather takes five times as long.
    // The permutation reads three bits of its index: two of the position, and the direction's.
    for (int axis = 0; axis < 3; ++axis) {
        const VI index = hn::IfVecThenElse(whole(4), flip[axis], from.v[axis]);
        const VI table = hn::Load(DI(), kAheadAlong[static_cast<std::size_t>(axis)].data());
        const V bits = hn::TableLookupLanes(hn::BitCast(D(), table), hn::Indices512<double>{index.raw});
        mask = hn::And(mask, hn::BitCast(DI(), bits));
    }
    return mask;
#endif
}

// Tried on three prints: more packets hide more of the memory's latency until their state fills the cache.
constexpr std::size_t kPackets = 8;
constexpr int kMinWaiting = kLanes / 2;  // lanes in surface cells that make a test worthwhile

template <bool kAny>
class Marcher {
public:
    Marcher(const BrickGrid& grid, const CellMap& map, std::span<const trace::Ray> rays, trace::Hit* hits,
            std::uint8_t* blocked)
        : grid_(grid),
          blocked_(blocked),
          macros_(grid),
          lazy_(grid.lazy()),
          bounded_(grid.cache().bounded()),
          by_slot_(grid.bitsBySlot()),
          cache_(grid.cache()),
          reading_(cache_),
          corners_(grid),
          batch_(corners_, map, rays, hits),
          queue_(grid, map, macros_, rays) {
        for (int axis = 0; axis < 3; ++axis) last_[axis] = grid.size()[static_cast<std::size_t>(axis)] - 1;
        for (Packet& packet : packets_)
            // Lanes without a ray are in cell 0 or where their last ray ended: their reads are valid, and ignored.
            for (auto& field : packet.field)
                for (double& value : field) value = 0;
    }

    void run() {
        // Each packet looks up its cells half a round after it has moved: the two halves of a step depend on each
        // other, so interleaving packets keeps the processor busy. The branch conditions are half a round old, too, so
        // that a mispredicted branch costs little. Slots are read another quarter of a round later.
        for (bool busy = true; busy;) {
            busy = false;
            if (bounded_ && (full_ || cache_.roomWanted())) releaseBricks();
            for (std::size_t n = 0; n < kPackets; ++n) {
                Packet& moving = packets_[n];
                if (moving.alive != 0) {
                    busy = true;
                    if (std::popcount(moving.waiting) >= kMinWaiting || moving.waiting == moving.alive)
                        solve(moving);
                    else
                        leap(moving);
                }
                Packet& looking = packets_[(n + kPackets / 2) % kPackets];
                queue_.refill(looking);
                if (looking.alive != 0) {
                    busy = true;
                    look(looking);
                }
                if (by_slot_) findWord(packets_[(n + kPackets / 4) % kPackets]);
            }
        }
        if constexpr (!kAny) {
            batch_.finishFull();
            batch_.flush();
        }
        if (bounded_) cache_.count(cells_);
    }

private:
    // The exit of a ray from a block, by the three planes ahead of it. Walk::aim().
    struct Exit {
        V t;
        M axis[3];
    };
    static HWY_INLINE Exit aim(const Packet& p, const VI plane[3]) {
        V t[3];
        for (int axis = 0; axis < 3; ++axis)
            t[axis] = (toReal(plane[axis]) - load(p, kO + axis)) * load(p, kInverse + axis);
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

    // Moves the lanes of `moving` to `next`. Walk::advance(). Rays that end free their lanes.
    HWY_INLINE void advance(Packet& p, const VI next[3], const Exit& exit, M moving) const {
        const D d;
        const DU du;
        M ended = hn::Ge(exit.t, load(p, kEnd));
        VI cell[3];
        for (int axis = 0; axis < 3; ++axis) {
            cell[axis] = hn::Xor(next[axis], loadWhole(p, kFlip + axis));
            const VI last = whole(last_[axis]);  // unsigned, so cells below 0 are beyond it, too
            ended = hn::Or(ended, hn::RebindMask(d, hn::Gt(hn::BitCast(du, cell[axis]), hn::BitCast(du, last))));
        }
        p.alive &= ~bitsOf(hn::And(ended, moving));
        moving = hn::AndNot(ended, moving);
        const auto moved = hn::RebindMask(DI(), moving);
        for (int axis = 0; axis < 3; ++axis)
            storeWhole(p, kCell + axis, hn::IfThenElse(moved, next[axis], loadWhole(p, kCell + axis)));
        store(p, kT, hn::IfThenElse(moving, exit.t, load(p, kT)));
        const V face =
            hn::IfThenElse(exit.axis[0], hn::Zero(d), hn::IfThenElse(exit.axis[1], constant(1), constant(2)));
        store(p, kFace, hn::IfThenElse(moving, face, load(p, kFace)));
        const VI macro = hn::IfThenElse(moved, macros_.at(cell), loadWhole(p, kMacro));
        storeWhole(p, kMacro, macro);
        // Beams have just read the macro cells that rays of a fan come to.
        if (macros_.large() && !queue_.isFan()) macros_.prefetch(p.field[kMacro]);
    }

    // findBlock() down to the bricks; prefetches the bits of their surface cells, or where those are by slot, the slot.
    void look(Packet& p) const {
        const DI di;
        const VI one = whole(1);
        const VI none = hn::Zero(di);
        VI flip[3];
        VI c[3];
        MaskPosition in_macro;  // of the brick
        for (int axis = 0; axis < 3; ++axis) {
            flip[axis] = loadWhole(p, kFlip + axis);
            c[axis] = hn::Xor(loadWhole(p, kCell + axis), flip[axis]);
            in_macro.v[axis] = hn::ShiftRight<3>(c[axis]);
        }
        const auto [bricks, rest] = macros_.read(p.field[kMacro]);

        const VI b = in_macro.bit();
        const VI bit = shiftedLeft(one, b);
        const auto has_brick = hn::TestBit(bricks, bit);
        const auto far = hn::Eq(bricks, none);
        const auto none_ahead = hn::Eq(aheadIn(bricks, in_macro, flip), none);
        const auto group_empty = hn::Eq(hn::And(bricks, groupAround(b)), none);
        const VI empty = hn::IfThenElse(none_ahead, whole(31), hn::IfThenElse(group_empty, whole(15), whole(7)));
        const VI low_bits = hn::IfThenElse(has_brick, whole(-1), empty);
        // Of a macro cell without bricks, how far all are empty: a byte an octant.
        VI octant_bits = none;
        for (int axis = 0; axis < 3; ++axis) octant_bits = hn::Or(octant_bits, hn::And(flip[axis], whole(32 >> axis)));
        const VI ahead = hn::And(shiftedRight(rest, octant_bits), whole(0xff));
        const VI beyond = hn::IfThenElseZero(far, hn::ShiftLeft<5>(ahead - one));
        const VI rank = hn::BitCast(di, hn::PopulationCount(hn::BitCast(DU(), hn::And(bricks, bit - one))));
        const VI half = hn::Or(hn::Or(hn::And(c[0], whole(4)), hn::ShiftRight<1>(hn::And(c[1], whole(4)))),
                               hn::ShiftRight<2>(hn::And(c[2], whole(4))));
        // Lanes without a brick read the first one's mask and ignore it.
        const VI brick = hn::ShiftLeft<3>(hn::And(rest, whole(0xffffffff)) + rank);
        const VI part = hn::IfThenElseZero(has_brick, brick + half);
        storeWhole(p, kPart, part);
        storeWhole(p, kLowBits, low_bits);
        storeWhole(p, kBeyond, beyond);
        if (by_slot_) {
            HWY_ALIGN Kept brick_of;
            hn::Store(hn::BitCast(D(), hn::ShiftRight<3>(part)), D(), brick_of);
            prefetch(grid_.slots(), brick_of);
        } else {
            storeWhole(p, kWord, part);
            // Beams have just read the bits of the blocks that rays of a fan come to.
            if (!queue_.isFan()) prefetch(reinterpret_cast<const std::uint64_t*>(grid_.clearCells()), p.field[kWord]);
        }
    }

    // By slot: the word of the surface cells after look().
    void findWord(Packet& p) const {
        const VI part = loadWhole(p, kPart);
        const VI word = wordOf(slotsOf(hn::ShiftRight<3>(part)), part);
        std::atomic_signal_fence(std::memory_order_acquire);  // the slots' bits are read later
        storeWhole(p, kWord, word);
        prefetch(reinterpret_cast<const std::uint64_t*>(grid_.clearCells()), p.field[kWord]);
    }

    // One step of every lane that isn't waiting: out of the largest empty block, or into the waiting state in a surface
    // cell.
    void leap(Packet& p) {
        const D d;
        const DI di;
        const VI one = whole(1);
        const VI none = hn::Zero(di);
        const VI part = loadWhole(p, kPart);
        const VI cells = hn::Not(gather(grid_.clearCells(), loadWhole(p, kWord)));
        VI cell[3];
        VI flip[3];
        MaskPosition c;
        for (int axis = 0; axis < 3; ++axis) {
            cell[axis] = loadWhole(p, kCell + axis);
            flip[axis] = loadWhole(p, kFlip + axis);
            c.v[axis] = hn::Xor(cell[axis], flip[axis]);
        }
        const VI at = c.bit();
        const VI empty = loadWhole(p, kLowBits);
        const M in_brick = toDouble(hn::Lt(empty, none));
        const M walking = maskOf(p.alive & ~p.waiting);
        const M surface = hn::And(in_brick, toDouble(hn::TestBit(cells, shiftedLeft(one, at))));
        const auto cells_empty = hn::Eq(hn::And(cells, groupAround(at)), none);
        const auto none_ahead = hn::Eq(aheadIn(cells, c, flip), none);
        const VI small = hn::IfThenElse(none_ahead, whole(3), hn::IfThenElseZero(cells_empty, one));
        const VI low_bits = hn::IfThenElse(hn::RebindMask(di, in_brick), small, empty);
        const VI beyond = loadWhole(p, kBeyond);

        startWaiting(p, bitsOf(hn::And(surface, walking)), part, at, c.v);
        VI last[3];
        VI plane[3];
        for (int axis = 0; axis < 3; ++axis) {
            last[axis] = hn::Or(cell[axis], low_bits) + beyond;
            plane[axis] = last[axis] + one;
        }
        const Exit exit = aim(p, plane);
        VI next[3];
        for (int axis = 0; axis < 3; ++axis) {
            const VI there = floorToWhole(load(p, kO + axis) + exit.t * load(p, kD + axis));
            const VI along = hn::Min(hn::Max(there, cell[axis]), last[axis]);
            next[axis] = hn::IfThenElse(hn::RebindMask(di, exit.axis[axis]), plane[axis], along);
        }
        advance(p, next, exit, hn::AndNot(surface, walking));
    }

    // Records and prefetches the corners of surface cells. Lanes for whose brick there is no free slot try again in
    // their next step.
    HWY_INLINE void startWaiting(Packet& p, unsigned found, VI part, VI at, const VI c[3]) {
        if (found == 0) return;
        VI slot_index = hn::ShiftRight<3>(part);  // of the brick's samples; in an eager grid the brick's own index
        if (lazy_) {
            // By slot, the bits are those of the slot that was looked up: only without one they may be others by now.
            VI slot = by_slot_ ? hn::ShiftRight<3>(loadWhole(p, kWord)) : slotsOf(slot_index);
            if (!by_slot_ || withoutSlot(slot, found) != 0) found = ensureSurface(found, slot, slot_index, part, at, c);
            if (bounded_ && found != 0) markUsed(found, slot);
            slot_index = slot - whole(BrickSlots::kFirst);
        }
        const VI seven = whole(7);
        const VI sample = product(slot_index, whole(BrickGrid::kBrickSamples)) +
                          product(hn::And(c[0], seven), whole(BrickGrid::kStrideX)) +
                          product(hn::And(c[1], seven), whole(BrickGrid::kStrideY)) + hn::And(c[2], seven);
        const auto newly = hn::RebindMask(DI(), maskOf(found));
        hn::Store(hn::IfThenElse(newly, sample, hn::Load(DI(), p.sample)), DI(), p.sample);
        p.waiting |= found;
        corners_.prefetch(p.sample);
    }

    HWY_INLINE VI slotsOf(VI brick) const {
        return hn::And(
            hn::GatherOffset(DI(), reinterpret_cast<const std::int64_t*>(grid_.slots()), hn::ShiftLeft<2>(brick)),
            whole(0xffffffff));
    }

    // Of clearCells() by slot; of a brick's number and part.
    static HWY_INLINE VI wordOf(VI slot, VI part) { return hn::ShiftLeft<3>(slot) + hn::And(part, whole(7)); }
    static HWY_INLINE unsigned withoutSlot(VI slot, unsigned among) {
        return bitsOf(toDouble(hn::Eq(slot, hn::Zero(DI())))) & among;
    }

    // The lanes whose bricks are laid out, after ensureBricks() for the others, and whose cells are surface cells.
    HWY_NOINLINE unsigned ensureSurface(unsigned found, VI& slot, VI brick, VI part, VI at, const VI c[3]) {
        unsigned not_there = withoutSlot(slot, found);
        if (not_there != 0) {
            ensureBricks(not_there, brick, c);
            std::atomic_signal_fence(std::memory_order_acquire);
            // Lanes that have a slot now read it before it can be evicted, so every brick laid out advances a ray.
            slot = slotsOf(brick);
            not_there = withoutSlot(slot, found);
        }
        // The bits may be older than the slot, if another thread laid the brick out in between: read them again.
        std::atomic_signal_fence(std::memory_order_acquire);
        const VI clear = gather(grid_.clearCells(), by_slot_ ? wordOf(slot, part) : part);
        return found & ~not_there & ~bitsOf(toDouble(hn::TestBit(clear, shiftedLeft(whole(1), at))));
    }

    HWY_NOINLINE void ensureBricks(unsigned lanes, VI brick, const VI c[3]) {
        HWY_ALIGN std::int64_t bricks[kLanes];
        HWY_ALIGN std::int64_t position[3][kLanes];
        hn::Store(brick, DI(), bricks);
        for (int axis = 0; axis < 3; ++axis) hn::Store(hn::ShiftRight<3>(c[axis]), DI(), position[axis]);
        for (unsigned rest = lanes; rest != 0; rest &= rest - 1) {
            const int lane = std::countr_zero(rest);
            if (!grid_.ensureBrick(static_cast<std::size_t>(bricks[lane]), static_cast<int>(position[0][lane]),
                                   static_cast<int>(position[1][lane]), static_cast<int>(position[2][lane])))
                full_ = true;
        }
    }

    // Marks the slots that these lanes read.
    HWY_NOINLINE void markUsed(unsigned lanes, VI slot) {
        HWY_ALIGN std::int64_t slots[kLanes];
        hn::Store(slot, DI(), slots);
        for (unsigned rest = lanes; rest != 0; rest &= rest - 1)
            cache_.mark(static_cast<std::uint32_t>(slots[std::countr_zero(rest)]));
        cells_ += static_cast<unsigned>(std::popcount(lanes));
    }

    // Finishes all reads of samples that have begun, so that bricks can be evicted.
    HWY_NOINLINE void releaseBricks() {
        for (Packet& packet : packets_) {
            if (packet.waiting == 0) continue;
            solve(packet);
            look(packet);
        }
        if constexpr (!kAny) {
            batch_.finishFull();
            batch_.flush();
        }
        cache_.makeRoom(full_);
        full_ = false;
    }

    // SegmentCubic and firstCrossing() for the waiting lanes. Those that don't hit walk on.
    void solve(Packet& p) {
        if constexpr (!kAny) batch_.finishFull();
        const D d;
        const V zero = hn::Zero(d);
        const V one = constant(1);
        const M waiting = maskOf(p.waiting);
        const VI ahead = whole(1);
        VI plane[3];
        for (int axis = 0; axis < 3; ++axis) plane[axis] = loadWhole(p, kCell + axis) + ahead;
        const Exit exit = aim(p, plane);
        const V t = load(p, kT);
        const V t_out = hn::Min(exit.t, load(p, kEnd));
        const M whole_cell = hn::Le(exit.t, load(p, kEnd));
        const V face = load(p, kFace);
        LaneCell in;
        for (int axis = 0; axis < 3; ++axis) {
            const V o = load(p, kO + axis);
            const V dir = load(p, kD + axis);
            // In the cell's own coordinates rays go either way.
            const V flip = load(p, kFlip + axis);
            const V back = hn::And(flip, constant(-0.0));
            const V cell = toReal(hn::Xor(loadWhole(p, kCell + axis), hn::BitCast(DI(), flip)));
            const V enter = clampTo(hn::Xor(o + t * dir, back) - cell, zero, one);
            const V leave = clampTo(hn::Xor(o + t_out * dir, back) - cell, zero, one);
            const V near = hn::And(flip, one);
            const M by_this = hn::Eq(face, constant(axis));
            in.from.v[axis] = hn::IfThenElse(by_this, near, enter);
            in.to.v[axis] = hn::IfThenElse(hn::And(whole_cell, exit.axis[axis]), hn::AndNot(flip, one), leave);
        }
        // Lanes that don't wait read the first samples; the results are ignored.
        const VI sample = hn::Load(DI(), p.sample);
        corners_.read(sample, in.v);
        const LaneCubic f = cubicOf(in);
        const M in0 = hn::Lt(f.c0, zero);
        const V three_c0 = constant(3) * f.c0;
        const M in1 = hn::Lt(three_c0 + f.c1, zero);
        const M in2 = hn::Lt(three_c0 + (constant(2) * f.c1 + f.c2), zero);
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
        hn::Store(hn::Zero(DI()), DI(), p.sample);
        p.alive &= ~hit;
        if constexpr (kAny) {
            // Other lanes write to a dummy.
            const auto address = [](const std::uint8_t* flag) { return std::bit_cast<std::int64_t>(flag); };
            const VI flags = floorToWhole(load(p, kIndex)) + whole(address(blocked_));
            HWY_ALIGN std::uint8_t* targets[kLanes];
            hn::Store(hn::IfThenElse(hn::RebindMask(DI(), maskOf(hit)), flags, whole(address(&ignored_))), DI(),
                      reinterpret_cast<std::int64_t*>(targets));
            for (std::uint8_t* target : targets) *target = 1;
        } else {
            batch_.push(hit, {load(p, kIndex), load(p, kStart), t, t_out, s}, in, sample);
        }
        VI next[3];
        for (int axis = 0; axis < 3; ++axis)
            next[axis] = hn::IfThenElse(hn::RebindMask(DI(), exit.axis[axis]), plane[axis], loadWhole(p, kCell + axis));
        advance(p, next, exit, hn::AndNot(maskOf(hit), waiting));
    }

    const BrickGrid& grid_;
    std::uint8_t* const blocked_;
    std::uint8_t ignored_ = 0;
    std::int64_t last_[3];  // cells
    const MacroTable macros_;
    const bool lazy_, bounded_, by_slot_;
    BrickSlots& cache_;
    const BrickSlots::Reading reading_;
    bool full_ = false;        // ensureBrick() found no free slot
    std::uint64_t cells_ = 0;  // surface cells read
    const CornerReader corners_;
    HitBatch batch_;
    RayQueue<!kAny> queue_;
    HWY_ALIGN Packet packets_[kPackets];
};

}  // namespace HWY_NAMESPACE
}  // namespace stratum::march
HWY_AFTER_NAMESPACE();
#endif  // STRATUM_WIDE_LANES

#endif
