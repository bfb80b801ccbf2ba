#include "voxelize/leaf/settling_kernels.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "voxelize/leaf/settling_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "voxelize/leaf/path_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace stratum::voxelize {
namespace HWY_NAMESPACE {

using I = hn::RebindToSigned<F>;

// Stores d and the direction of (x, y), which points from the path to the sample. On the path itself it is none.
HWY_INLINE void storePlan(VF d, VF x, VF y, VF length, std::size_t c, BeadPlan& out) {
    const F f;
    const VF inverse = hn::Div(hn::Set(f, 1.0F), hn::Max(length, hn::Set(f, 1e-30F)));
    hn::Store(d, f, out.d.v + c);
    hn::Store(hn::Mul(x, inverse), f, out.nx.v + c);
    hn::Store(hn::Mul(y, inverse), f, out.ny.v + c);
}

void PlanOfLine(const ColumnGrid& grid, const LocalLine& line, BeadPlan& out) {
    const F f;
    VF least = hn::Set(f, 3e38F);
    forEachVector([&](std::size_t c) HWY_ATTR {
        const VF qx = hn::Load(f, grid.qx.v + c);
        const VF qy = hn::Load(f, grid.qy.v + c);
        const VF n = across(line, qx, qy);
        VF x = hn::Mul(n, hn::Set(f, line.nx));
        VF y = hn::Mul(n, hn::Set(f, line.ny));
        VF rho = hn::Abs(n);  // as distance() has it
        if (!line.spans) {
            const VF s = along(line, qx, qy);
            const VF past = hn::Sub(s, hn::Min(hn::Max(s, hn::Set(f, line.lo)), hn::Set(f, line.hi)));
            x = hn::Add(x, hn::Mul(past, hn::Set(f, line.ux)));
            y = hn::Add(y, hn::Mul(past, hn::Set(f, line.uy)));
            rho = hn::Sqrt(dot(n, past, n, past));
        }
        storePlan(hn::Sub(rho, hn::Set(f, line.half_flat)), x, y, rho, c, out);
        least = hn::Min(least, rho);
    });
    out.least = std::max(hn::GetLane(hn::MinOfLanes(f, least)) - line.half_flat, 0.0F);
}

void PlanOfTaper(const ColumnGrid& grid, const LocalTaper& taper, BeadPlan& out) {
    const F f;
    VF least = hn::Set(f, 3e38F);
    forEachVector([&](std::size_t c) HWY_ATTR {
        const VF qx = hn::Load(f, grid.qx.v + c);
        const VF qy = hn::Load(f, grid.qy.v + c);
        const VF n = across(taper.line, qx, qy);
        const TaperPoint point = nearest(taper, qx, qy);
        const VF x = dot(n, point.past, hn::Set(f, taper.line.nx), hn::Set(f, taper.line.ux));
        const VF y = dot(n, point.past, hn::Set(f, taper.line.ny), hn::Set(f, taper.line.uy));
        storePlan(point.d, x, y, point.rho, c, out);
        least = hn::Min(least, point.d);
    });
    out.least = std::max(hn::GetLane(hn::MinOfLanes(f, least)), 0.0F);
}

void PlanOfArc(const ColumnGrid& grid, const LocalArc& arc, BeadPlan& out) {
    const F f;
    const VF zero = hn::Zero(f);
    VF least = hn::Set(f, 3e38F);
    forEachVector([&](std::size_t c) HWY_ATTR {
        const VF qx = hn::Load(f, grid.qx.v + c);
        const VF qy = hn::Load(f, grid.qy.v + c);
        // Along the radius, inwards inside the circle.
        const VF vx = hn::Add(qx, hn::Set(f, arc.vx));
        const VF vy = hn::Add(qy, hn::Set(f, arc.vy));
        const VF v = hn::Sqrt(dot(vx, vy, vx, vy));
        const auto inside = hn::Lt(v, hn::Set(f, arc.radius));
        VF x = hn::IfThenElse(inside, hn::Sub(zero, vx), vx);
        VF y = hn::IfThenElse(inside, hn::Sub(zero, vy), vy);
        VF length = v;
        if (!arc.full) {
            const VF ax = hn::Sub(qx, hn::Set(f, arc.start_x));
            const VF ay = hn::Sub(qy, hn::Set(f, arc.start_y));
            const VF bx = hn::Sub(qx, hn::Set(f, arc.end_x));
            const VF by = hn::Sub(qy, hn::Set(f, arc.end_y));
            const VF a2 = dot(ax, ay, ax, ay);
            const VF b2 = dot(bx, by, bx, by);
            const auto at_start = hn::Lt(a2, b2);
            const auto on_arc = withinSweep(arc, qx, qy);
            x = hn::IfThenElse(on_arc, x, hn::IfThenElse(at_start, ax, bx));
            y = hn::IfThenElse(on_arc, y, hn::IfThenElse(at_start, ay, by));
            length = hn::IfThenElse(on_arc, v, hn::Sqrt(hn::Min(a2, b2)));
        }
        const VF rho = distance(arc, qx, qy);
        storePlan(hn::Sub(rho, hn::Set(f, arc.half_flat)), x, y, length, c, out);
        least = hn::Min(least, rho);
    });
    out.least = std::max(hn::GetLane(hn::MinOfLanes(f, least)) - arc.half_flat, 0.0F);
}

void MinimumOfPlans(std::span<const BeadPlan> plans, PlanField& d) {
    const F f;
    forEachVector([&](std::size_t c) HWY_ATTR {
        VF least = hn::Load(f, d.v + c);
        for (const BeadPlan& plan : plans) least = hn::Min(least, hn::Load(f, plan.d.v + c));
        hn::Store(least, f, d.v + c);
    });
}

// Linear interpolation in the table, at z in [0, 1].
HWY_INLINE VF lookUp(const float* table, VF z) {
    const F f;
    const I i;
    constexpr int kSteps = SettlingCurve::kSteps;
    const VF at = hn::Mul(z, hn::Set(f, static_cast<float>(kSteps)));
    const auto step = hn::Min(hn::ConvertTo(i, at), hn::Set(i, kSteps - 1));
    const VF low = hn::GatherIndex(f, table, step);
    const VF high = hn::GatherIndex(f, table + 1, step);
    return hn::Add(low, hn::Mul(hn::Sub(at, hn::ConvertTo(f, step)), hn::Sub(high, low)));
}

// Half the gap between two beads at one vector of samples, radii, larger where they don't lie opposite.
HWY_INLINE VF halfGap(const BeadPlan& a, const BeadPlan& b, std::size_t c, const GrooveRule& rule) {
    const F f;
    const VF zero = hn::Zero(f);
    const VF gap = hn::Add(hn::Max(hn::Load(f, a.d.v + c), zero), hn::Max(hn::Load(f, b.d.v + c), zero));
    const VF cosine =
        dot(hn::Load(f, a.nx.v + c), hn::Load(f, a.ny.v + c), hn::Load(f, b.nx.v + c), hn::Load(f, b.ny.v + c));
    const VF off = hn::Mul(hn::Max(hn::Sub(cosine, hn::Set(f, static_cast<float>(kOpposite))), zero),
                           hn::Set(f, static_cast<float>(-1 / kOpposite)));
    const VF penalty = hn::Mul(hn::Set(f, static_cast<float>(0.5 * kTurnPenalty)), hn::Mul(off, off));
    return hn::Add(hn::Mul(gap, hn::Set(f, 1 / (2 * rule.radius))), penalty);
}

// The level of a groove, below a half gap of 1.
HWY_INLINE VF levelOf(VF half_gap, const GrooveRule& rule) {
    const F f;
    const VF one = hn::Set(f, 1.0F);
    const VF open = hn::Mul(hn::Sub(half_gap, hn::Set(f, rule.closing)), hn::Set(f, rule.per_open));
    const VF q = hn::Min(hn::Max(open, hn::Zero(f)), one);
    const VF z = hn::Sub(one, hn::Sqrt(hn::Sub(one, hn::Sqrt(q))));
    return hn::Mul(lookUp(rule.table, z), hn::Set(f, rule.radius));
}

void LevelsBetween(std::span<const BeadPlan> plans, std::span<const std::uint32_t> which, const PlanField& d,
                   const GrooveRule& rule, PlanField& levels) {
    const F f;
    const VF two_radii = hn::Set(f, 2 * rule.radius);
    constexpr std::size_t kSome = 64;  // beads at a time
    const BeadPlan* near[2][kSome];
    forEachVector([&](std::size_t c) HWY_ATTR {
        const VF least = hn::Load(f, d.v + c);
        // Of all pairs the narrowest gap has the lowest level.
        VF narrowest = hn::Set(f, 1.0F);
        // Of all beads of a column few are near to the samples of one vector.
        const auto gather = [&](std::size_t first, const BeadPlan** found) HWY_ATTR {
            std::size_t count = 0;
            for (const std::uint32_t n : which.subspan(first, std::min(kSome, which.size() - first))) {
                found[count] = &plans[n];
                count += hn::AllFalse(f, hn::Lt(hn::Load(f, plans[n].d.v + c), two_radii)) ? 0 : 1;
            }
            return count;
        };
        const auto lower = [&](const BeadPlan& a, const BeadPlan& b) HWY_ATTR {
            if (a.least + b.least < 2 * rule.radius) narrowest = hn::Min(narrowest, halfGap(a, b, c, rule));
        };
        const bool deep = hn::AllFalse(f, hn::Gt(least, hn::Set(f, -rule.weld_level)));
        for (std::size_t first = 0; !deep && first < which.size(); first += kSome) {
            const std::size_t count = gather(first, near[0]);
            for (std::size_t a = 0; a < count; ++a)
                for (std::size_t b = a + 1; b < count; ++b) lower(*near[0][a], *near[0][b]);
            for (std::size_t second = first + kSome; count > 0 && second < which.size(); second += kSome) {
                const std::size_t others = gather(second, near[1]);
                for (std::size_t a = 0; a < count; ++a)
                    for (std::size_t b = 0; b < others; ++b) lower(*near[0][a], *near[1][b]);
            }
        }
        // Deep in a flat nothing changes.
        const auto fills = hn::And(hn::Lt(narrowest, hn::Set(f, 1.0F)), hn::Gt(least, hn::Set(f, -rule.weld_level)));
        const VF none = hn::Set(f, kNoGroove);
        hn::Store(hn::AllFalse(f, fills) ? none : hn::IfThenElse(fills, levelOf(narrowest, rule), none), f,
                  levels.v + c);
    });
}

float FillGrooves(const PlanField& levels, const GrooveRule& rule, PlanField& d, PlanField& sides2) {
    const F f;
    const VF weld_level = hn::Set(f, rule.weld_level);
    const VF per_radius = hn::Set(f, rule.weld_level / rule.radius);
    VF least = hn::Set(f, 3e38F);
    forEachVector([&](std::size_t c) HWY_ATTR {
        const VF nearest = hn::Load(f, d.v + c);
        const VF level = hn::Load(f, levels.v + c);
        const VF side = hn::Max(hn::Min(nearest, level), hn::Zero(f));
        const VF squared = hn::Mul(side, side);
        hn::Store(squared, f, sides2.v + c);
        least = hn::Min(least, squared);
        // weld_level (1 - level / radius) below the level: nothing where the groove is as deep as without filling.
        const VF welded = hn::Sub(hn::Add(level, hn::Mul(level, per_radius)), weld_level);
        hn::Store(hn::Min(nearest, welded), f, d.v + c);
    });
    return hn::GetLane(hn::MinOfLanes(f, least));
}

float MoveOut(const PlanField& out, PlanField& d, PlanField& sides2) {
    const F f;
    VF least = hn::Set(f, 3e38F);
    forEachVector([&](std::size_t c) HWY_ATTR {
        const VF by = hn::Load(f, out.v + c);
        const VF side = hn::Max(hn::Sub(hn::Sqrt(hn::Load(f, sides2.v + c)), by), hn::Zero(f));
        const VF squared = hn::Mul(side, side);
        hn::Store(squared, f, sides2.v + c);
        least = hn::Min(least, squared);
        hn::Store(hn::Sub(hn::Load(f, d.v + c), by), f, d.v + c);
    });
    return hn::GetLane(hn::MinOfLanes(f, least));
}

}  // namespace HWY_NAMESPACE
}  // namespace stratum::voxelize
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stratum::voxelize {

HWY_EXPORT(PlanOfLine);
HWY_EXPORT(PlanOfTaper);
HWY_EXPORT(PlanOfArc);
HWY_EXPORT(MinimumOfPlans);
HWY_EXPORT(LevelsBetween);
HWY_EXPORT(FillGrooves);
HWY_EXPORT(MoveOut);

GrooveRule::GrooveRule(const SettlingCurve& curve, double the_radius)
    : table(curve.table().data()),
      radius(static_cast<float>(the_radius)),
      closing(static_cast<float>(curve.closing())),
      per_open(static_cast<float>(1 / (1 - curve.closing()))),
      weld_level(static_cast<float>(curve.weldLevel() * the_radius)) {}

bool mayFill(const LocalLine& line, const GrooveRule& rule, double half_extent) {
    constexpr double kSlack = 1e-5;  // of floats
    return line.fromMiddle() * (1 - kSlack) < 2 * static_cast<double>(rule.radius) + half_extent * std::sqrt(2.0);
}

void planOfLine(const ColumnGrid& grid, const LocalLine& line, BeadPlan& out) {
    HWY_DYNAMIC_DISPATCH(PlanOfLine)(grid, line, out);
}
void planOfTaper(const ColumnGrid& grid, const LocalTaper& taper, BeadPlan& out) {
    HWY_DYNAMIC_DISPATCH(PlanOfTaper)(grid, taper, out);
}
void planOfArc(const ColumnGrid& grid, const LocalArc& arc, BeadPlan& out) {
    HWY_DYNAMIC_DISPATCH(PlanOfArc)(grid, arc, out);
}
void minimumOfPlans(std::span<const BeadPlan> plans, PlanField& d) { HWY_DYNAMIC_DISPATCH(MinimumOfPlans)(plans, d); }
void levelsBetween(std::span<const BeadPlan> plans, std::span<const std::uint32_t> which, const PlanField& d,
                   const GrooveRule& rule, PlanField& levels) {
    HWY_DYNAMIC_DISPATCH(LevelsBetween)(plans, which, d, rule, levels);
}
float fillGrooves(const PlanField& levels, const GrooveRule& rule, PlanField& d, PlanField& sides2) {
    return HWY_DYNAMIC_DISPATCH(FillGrooves)(levels, rule, d, sides2);
}

float moveOut(const PlanField& out, PlanField& d, PlanField& sides2) {
    return HWY_DYNAMIC_DISPATCH(MoveOut)(out, d, sides2);
}

}  // namespace stratum::voxelize
#endif  // HWY_ONCE
