// Vectors of doubles and of whole numbers, masks as bits, and tables to pack and spread lanes: for one Highway target
// at a time, hence the guard that toggles.
#if defined(STRATUM_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef STRATUM_LANES_INL_H
#undef STRATUM_LANES_INL_H
#else
#define STRATUM_LANES_INL_H
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <bit>
#include <cstddef>
#include <cstdint>

#undef STRATUM_WIDE_LANES
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2  // Highway numbers the better ones lower, those of later releases, too
#define STRATUM_WIDE_LANES 1
#else
#define STRATUM_WIDE_LANES 0  // with two lanes gathers cost more than they save
#endif

#if STRATUM_WIDE_LANES
HWY_BEFORE_NAMESPACE();
namespace stratum::march {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using DI = hn::RebindToSigned<D>;
using DU = hn::RebindToUnsigned<D>;
using DU32 = hn::Repartition<std::uint32_t, D>;
using DF = hn::Rebind<float, D>;
using DHalfU32 = hn::Rebind<std::uint32_t, D>;
using V = hn::Vec<D>;
using VI = hn::Vec<DI>;
using M = hn::Mask<D>;

constexpr int kLanes = static_cast<int>(hn::MaxLanes(D()));
constexpr unsigned kAllLanes = (1U << kLanes) - 1;
constexpr double kShift = 6755399441055744.0;  // 1.5 * 2^52: adding it leaves a whole number in a double's low bits

struct Vec3 {
    V v[3];
};

HWY_INLINE V constant(double value) { return hn::Set(D(), value); }
HWY_INLINE VI whole(std::int64_t value) { return hn::Set(DI(), value); }
HWY_INLINE M maskOf(unsigned bits) {
    alignas(8) const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits)};
    return hn::LoadMaskBits(D(), bytes);
}
HWY_INLINE unsigned bitsOf(M mask) {
    alignas(8) std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(D(), mask, bytes);
    return bytes[0] & kAllLanes;
}
HWY_INLINE M toDouble(hn::Mask<DI> mask) { return hn::RebindMask(D(), mask); }
/// Of whole numbers in (-2^51, 2^51).
HWY_INLINE V toReal(VI v) {
#if HWY_TARGET == HWY_AVX2
    const V shift = constant(kShift);
    return hn::BitCast(D(), v + hn::BitCast(DI(), shift)) - shift;
#else
    return hn::ConvertTo(D(), v);
#endif
}
/// Of numbers in that range.
HWY_INLINE VI floorToWhole(V v) {
#if HWY_TARGET == HWY_AVX2
    const V shift = constant(kShift);
    return hn::BitCast(DI(), hn::Floor(v) + shift) - hn::BitCast(DI(), shift);
#else
    // One instruction; Highway's ConvertTo() rounds towards 0 and has two more for what is out of range.
    return VI{_mm512_cvt_roundpd_epi64(v.raw, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC)};
#endif
}
/// Of whole numbers in [0, 2^32).
HWY_INLINE VI product(VI a, VI b) {
    return hn::BitCast(DI(), hn::MulEven(hn::BitCast(DU32(), a), hn::BitCast(DU32(), b)));
}
HWY_INLINE VI shiftedLeft(VI v, VI count) {
    return hn::BitCast(DI(), hn::BitCast(DU(), v) << hn::BitCast(DU(), count));
}
HWY_INLINE VI shiftedRight(VI v, VI count) {
    return hn::BitCast(DI(), hn::BitCast(DU(), v) >> hn::BitCast(DU(), count));
}
/// Of a table of eight bytes a row.
HWY_INLINE VI gather(const void* table, VI row) {
    return hn::GatherIndex(DI(), static_cast<const std::int64_t*>(table), row);
}
/// Whole numbers in memory, one a lane, with the types of packets' fields.
using Kept = double[kLanes];
HWY_INLINE std::int64_t keptIn(const Kept& lanes, int lane) { return std::bit_cast<std::int64_t>(lanes[lane]); }
/// Of a table of 16 bytes a row, both halves, by the offsets of rows in bytes. By one load a row: a gather reads each
/// half of each row on its own.
struct Halves {
    VI first, second;
};
HWY_INLINE Halves loadHalves(const std::byte* table, const Kept& offsets) {
    const hn::CappedTag<std::int64_t, 2> two;
    const auto both = [&](int lane) HWY_ATTR {
        return hn::LoadU(two, reinterpret_cast<const std::int64_t*>(table + keptIn(offsets, lane)));
    };
#if HWY_TARGET == HWY_AVX2
    const VI even = hn::Combine(DI(), both(2), both(0));
    const VI odd = hn::Combine(DI(), both(3), both(1));
#else
    const hn::CappedTag<std::int64_t, 4> four;
    const VI even = hn::Combine(DI(), hn::Combine(four, both(6), both(4)), hn::Combine(four, both(2), both(0)));
    const VI odd = hn::Combine(DI(), hn::Combine(four, both(7), both(5)), hn::Combine(four, both(3), both(1)));
#endif
    return {hn::InterleaveLower(even, odd), hn::InterleaveUpper(DI(), even, odd)};
}
/// Entries of a table into the first-level cache.
template <typename T>
HWY_INLINE void prefetch(const T* table, const Kept& index) {
    for (int lane = 0; lane < kLanes; ++lane) hwy::Prefetch(table + keptIn(index, lane));
}
/// std::clamp, operand for operand.
HWY_INLINE V clampTo(V v, V low, V high) { return hn::Min(hn::Max(v, low), high); }

/// Permutations for every mask of lanes.
struct LaneTable {
    std::uint8_t rank[kAllLanes + 1][8] = {};  // to spread a row over the lanes set: lane -> how many are set below it
    std::uint8_t source[kAllLanes + 1][8] = {};  // to gather the lanes set in a row: n -> the n-th lane set
    constexpr LaneTable() {
        for (unsigned mask = 0; mask <= kAllLanes; ++mask)
            for (unsigned lane = 0, count = 0; lane < static_cast<unsigned>(kLanes); ++lane) {
                rank[mask][lane] = static_cast<std::uint8_t>(count);
                if ((mask >> lane & 1) != 0) source[mask][count++] = static_cast<std::uint8_t>(lane);
            }
    }
};
inline constexpr LaneTable kTable;

HWY_INLINE auto tableIndices(const std::uint8_t (&row)[8]) {
    alignas(64) std::int64_t source[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) source[lane] = row[lane];
    return hn::SetTableIndices(D(), source);
}

}  // namespace HWY_NAMESPACE
}  // namespace stratum::march
HWY_AFTER_NAMESPACE();
#endif  // STRATUM_WIDE_LANES

#endif
