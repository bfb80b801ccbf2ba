// Angles in vectors, by polynomials: for one Highway target at a time, hence the guard that toggles.
//
// Angles are in turns or quarters of a turn, so that nothing is divided by pi. The same bits on every target.
#if defined(STRATUM_ANGLE_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef STRATUM_ANGLE_LANES_INL_H
#undef STRATUM_ANGLE_LANES_INL_H
#else
#define STRATUM_ANGLE_LANES_INL_H
#endif

#include <hwy/highway.h>

#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace stratum::shade {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// The sum of v^n times the coefficients, which begin with that of the largest n.
template <class D, class V = hn::Vec<D>, typename... Coefficients>
HWY_INLINE V polynomial(D d, V v, double first, Coefficients... rest) {
    using T = hn::TFromD<D>;
    V sum = hn::Set(d, static_cast<T>(first));
    ((sum = hn::Add(hn::Mul(sum, v), hn::Set(d, static_cast<T>(rest)))), ...);
    return sum;
}

/// Sine and cosine of an angle in turns, |t| < 2^20. Taylor's series up to an eighth of a turn: to 2e-9 in doubles.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void sineAndCosine(D d, V t, V& sine, V& cosine) {
    const auto set = [d](double v) HWY_ATTR { return hn::Set(d, static_cast<hn::TFromD<D>>(v)); };
    const V quarters = hn::Round(hn::Mul(t, set(4.0)));
    const V a = hn::Mul(hn::Sub(t, hn::Mul(quarters, set(0.25))), set(2.0 * std::numbers::pi));
    const V a2 = hn::Mul(a, a);
    const V s = hn::Mul(polynomial(d, a2, 1.0 / 362880.0, -1.0 / 5040.0, 1.0 / 120.0, -1.0 / 6.0, 1.0), a);
    const V c = polynomial(d, a2, -1.0 / 3628800.0, 1.0 / 40320.0, -1.0 / 720.0, 1.0 / 24.0, -0.5, 1.0);
    const V turn = hn::Sub(quarters, hn::Mul(set(4.0), hn::Floor(hn::Mul(quarters, set(0.25)))));  // 0, 1, 2 or 3
    const auto swap = hn::Or(hn::Eq(turn, set(1.0)), hn::Eq(turn, set(3.0)));
    const V sines = hn::IfThenElse(swap, c, s);
    const V cosines = hn::IfThenElse(swap, s, c);
    sine = hn::IfThenElse(hn::Ge(turn, set(2.0)), hn::Neg(sines), sines);
    const auto left = hn::Or(hn::Eq(turn, set(1.0)), hn::Eq(turn, set(2.0)));
    cosine = hn::IfThenElse(left, hn::Neg(cosines), cosines);
}

/// atan2, times turn / (2 pi): 1 for turns, 4 for quarters of a turn. To 4e-9 turns in doubles, 1e-7 in floats. The
/// series: M. Abramowitz, I. Stegun, "Handbook of Mathematical Functions", 4.4.49.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V arcTurns(D d, V y, V x, double turn = 1.0) {
    const auto set = [d](double v) HWY_ATTR { return hn::Set(d, static_cast<hn::TFromD<D>>(v)); };
    const V ax = hn::Abs(x);
    const V ay = hn::Abs(y);
    const V high = hn::Max(ax, ay);
    const V r = hn::IfThenElseZero(hn::Gt(high, set(0.0)), hn::Div(hn::Min(ax, ay), high));
    const V r2 = hn::Mul(r, r);
    V a = polynomial(d, r2, 0.0028662257, -0.0161657367, 0.0429096138, -0.0752896400, 0.1065626393, -0.1420889944,
                     0.1999355085, -0.3333314528, 1.0);
    a = hn::Mul(hn::Mul(a, r), set(turn / (2.0 * std::numbers::pi)));
    a = hn::IfThenElse(hn::Gt(ay, ax), hn::Sub(set(0.25 * turn), a), a);
    a = hn::IfThenElse(hn::Lt(x, set(0.0)), hn::Sub(set(0.5 * turn), a), a);
    return hn::CopySign(a, y);
}

}  // namespace HWY_NAMESPACE
}  // namespace stratum::shade
HWY_AFTER_NAMESPACE();

#endif
