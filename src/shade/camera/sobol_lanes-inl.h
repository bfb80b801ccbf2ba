// Sampler's draws in vectors: sobol's functions on as many numbers as a vector has. Included once for each target of
// Highway, inside its namespace there.
#if defined(STRATUM_SHADE_SOBOL_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef STRATUM_SHADE_SOBOL_INL_H
#undef STRATUM_SHADE_SOBOL_INL_H
#else
#define STRATUM_SHADE_SOBOL_INL_H
#endif

#include "shade/camera/sampler.h"

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace stratum::shade {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using U = hn::CappedTag<std::uint32_t, 16>;
using VU = hn::Vec<U>;

HWY_INLINE VU set(std::uint32_t v) { return hn::Set(U(), v); }

template <int kBits>
HWY_INLINE VU swapBits(VU v, std::uint32_t low) {
    return hn::Or(hn::And(hn::ShiftRight<kBits>(v), set(low)), hn::ShiftLeft<kBits>(hn::And(v, set(low))));
}
HWY_INLINE VU reverseBits(VU v) {
    v = hn::Or(hn::ShiftRight<16>(v), hn::ShiftLeft<16>(v));
    v = swapBits<8>(v, 0x00ff00ffu);
    v = swapBits<4>(v, 0x0f0f0f0fu);
    v = swapBits<2>(v, 0x33333333u);
    return swapBits<1>(v, 0x55555555u);
}
// sobol::hash and the middle of sobol::owenScramble, between its two reversals.
HWY_INLINE VU hash(VU v) {
    v = hn::Mul(hn::Xor(v, hn::ShiftRight<16>(v)), set(0x7feb352du));
    v = hn::Mul(hn::Xor(v, hn::ShiftRight<15>(v)), set(0x846ca68bu));
    return hn::Xor(v, hn::ShiftRight<16>(v));
}
/// @param b_hashed  hash(b)
HWY_INLINE VU hashPair(VU a, VU b_hashed) {
    const VU mixed = hn::Add(hn::Add(hn::Add(b_hashed, set(0x9e3779b9u)), hn::ShiftLeft<6>(a)), hn::ShiftRight<2>(a));
    return hash(hn::Xor(a, mixed));
}
HWY_INLINE VU scrambleReversed(VU v, VU seed) {
    v = hn::Xor(v, hn::Mul(v, set(0x3d20adeau)));
    v = hn::Add(v, seed);
    v = hn::Mul(v, hn::Or(hn::ShiftRight<16>(seed), set(1u)));
    v = hn::Xor(v, hn::Mul(v, set(0x05526c56u)));
    return hn::Xor(v, hn::Mul(v, set(0x53a22864u)));
}
// sobol::dimension1 before its reversal.
HWY_INLINE VU pascal(VU v) {
    v = hn::Xor(v, hn::ShiftRight<16>(v));
    v = hn::Xor(v, hn::ShiftRight<8>(hn::And(v, set(0xff00ff00u))));
    v = hn::Xor(v, hn::ShiftRight<4>(hn::And(v, set(0xf0f0f0f0u))));
    v = hn::Xor(v, hn::ShiftRight<2>(hn::And(v, set(0xccccccccu))));
    return hn::Xor(v, hn::ShiftRight<1>(hn::And(v, set(0xaaaaaaaau))));
}

/// The first 32 bits of both numbers of Sampler::next2D.
struct Draw2D {
    VU x, y;
};
HWY_INLINE Draw2D draw2D(VU block, VU index, VU draw) {
    const VU key = hashPair(block, hash(draw));
    // The bit reversal at the end of owenScramble cancels with that in dimension0, and the one in dimension1 with that
    // at the beginning of the next scramble.
    const VU reversed = reverseBits(scrambleReversed(reverseBits(index), key));
    return {reverseBits(scrambleReversed(reversed, hashPair(key, set(sobol::hash(1u))))),
            reverseBits(scrambleReversed(pascal(reversed), hashPair(key, set(sobol::hash(2u)))))};
}

}  // namespace HWY_NAMESPACE
}  // namespace stratum::shade
HWY_AFTER_NAMESPACE();

#endif  // STRATUM_SHADE_SOBOL_INL_H
