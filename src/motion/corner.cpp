#include "motion/corner.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace stratum::motion {
namespace {

using gcode::CornerRule;
using gcode::kMotionAxes;
using gcode::MachineLimits;

// A stop and a new start may be faster than the corner.
double orRest(double speed, const Segment& from, const Segment& to, const MachineLimits& limits) {
    const double safe_to = restSpeed(to, limits);
    return restSpeed(from, limits) > 0.99 * speed && safe_to > 0.99 * speed ? safe_to : speed;
}

double jerkCorner(const Segment& from, const Segment& to, const MachineLimits& limits) {
    // The slicers' estimators use the programmed speed of the previous segment, not the limited one.
    const double speed_from = limits.rule == CornerRule::slicer_jerk ? from.asked : from.speed;
    const double slower = std::min(speed_from, to.speed);
    // The corner is passed at the lower of the two speeds, but a faster successor may start with its own.
    const double before = speed_from > to.speed ? from.speed * to.speed / speed_from : from.speed;
    double factor = 1;
    for (std::size_t axis = 0; axis < kMotionAxes; ++axis) {
        const double jump = axisJump(from.direction[axis] * before * factor, to.direction[axis] * to.speed * factor);
        if (jump > limits.jerk[axis]) factor *= limits.jerk[axis] / jump;
    }
    return orRest(slower * factor, from, to, limits);
}

// The direction at a segment's end, x, y, z; of a whole arc its tangent in the plan.
std::array<double, 3> exitOf(const Segment& segment) {
    return {segment.exit[0], segment.exit[1], segment.whole_arc ? 0 : segment.direction[2]};
}

// Into an arc each axis may jump by its jerk at the speed that both share. Else it is the change of the velocity along
// x, y and z, one after the other, each after what those before it have taken.
double bambuCorner(const Segment& from, const Segment& to, const MachineLimits& limits) {
    const double before = std::min(from.speed, to.speed);
    const std::array<double, 3> exit = exitOf(from);
    if (to.whole_arc) {
        const std::array<double, 3> entry{to.direction[0], to.direction[1], 0};
        const double flat = std::hypot(entry[0], entry[1]);
        const double unit = std::hypot(exit[0], exit[1], exit[2]);
        double speed = MachineLimits::kNone;
        for (std::size_t axis = 0; axis < exit.size(); ++axis)
            if (const double jump = std::abs(entry[axis] / flat - (unit > 0 ? exit[axis] / unit : 0)); jump > 0)
                speed = std::min(speed, limits.jerk[axis] / jump);
        return orRest(speed < MachineLimits::kNone ? speed : before, from, to, limits);
    }
    double factor = 1;
    std::array<double, 3> jump{};
    for (std::size_t axis = 0; axis < jump.size(); ++axis)
        jump[axis] = std::abs(to.direction[axis] * to.speed - exit[axis] * before);
    for (std::size_t axis = 0; axis < jump.size(); ++axis) {
        if (!(jump[axis] > limits.jerk[axis])) continue;
        factor *= limits.jerk[axis] / jump[axis];
        for (double& each : jump) each *= factor;
    }
    const double e = axisJump(from.direction[3] * before * factor, to.direction[3] * to.speed * factor);
    if (e > limits.jerk[3]) factor *= limits.jerk[3] / e;
    return orRest(before * factor, from, to, limits);
}

double planJerkCorner(const Segment& from, const Segment& to, const MachineLimits& limits) {
    const auto jump = [&](std::size_t axis) {
        return std::abs(to.direction[axis] * to.speed - from.direction[axis] * from.speed);
    };
    double factor = 1;
    const double plan = std::hypot(jump(0), jump(1));
    if (plan > limits.jerk[0]) factor = limits.jerk[0] / plan;
    for (const std::size_t axis : {std::size_t{2}, std::size_t{3}})
        if (jump(axis) > limits.jerk[axis]) factor = std::min(factor, limits.jerk[axis] / jump(axis));
    return std::min(from.speed, to.speed * factor);
}

// Every axis may jump by its jerk at the speed that both segments share.
double repRapCorner(const Segment& from, const Segment& to, const MachineLimits& limits) {
    // By default a move begins at rest after one of another kind: printing, travelling, retracting.
    const auto inPlane = [](const Segment& s) { return s.direction[0] != 0 || s.direction[1] != 0; };
    const auto prints = [&](const Segment& s) { return inPlane(s) && s.direction[3] > 0; };
    const auto drives = [&](const Segment& s) { return s.direction[3] != 0 && !prints(s); };
    if (limits.jerk_policy == 0 &&
        (inPlane(from) != inPlane(to) || prints(from) != prints(to) || drives(from) != drives(to)))
        return 0;
    double speed = std::min(from.speed, to.speed);
    for (std::size_t axis = 0; axis < kMotionAxes; ++axis) {
        const double jump = std::abs(to.direction[axis] - from.direction[axis]);
        if (jump * speed > limits.jerk[axis]) speed = limits.jerk[axis] / jump;
    }
    return speed;
}

}  // namespace

double axisJump(double before, double after) {
    if (before > after) return after > 0 || before < 0 ? before - after : std::max(before, -after);
    return after < 0 || before > 0 ? after - before : std::max(-before, after);
}

double restSpeed(const Segment& segment, const MachineLimits& limits) {
    double speed = segment.speed;
    switch (limits.rule) {
        case CornerRule::reprap_jerk:
            return 0;
        case CornerRule::plan_jerk:
            // Half the change of speed, and for the slow axes only if theirs is larger.
            speed = std::min(speed, limits.jerk[0] / 2);
            for (const std::size_t axis : {std::size_t{2}, std::size_t{3}})
                if (std::abs(segment.direction[axis]) * segment.speed > limits.jerk[axis] / 2)
                    speed = std::min(speed, limits.jerk[axis] / 2);
            return speed;
        default:
            for (std::size_t axis = 0; axis < kMotionAxes; ++axis)
                if (segment.share(axis) * segment.speed > limits.jerk[axis]) speed = std::min(speed, limits.jerk[axis]);
            return speed;
    }
}

double curveSpeed(const Segment* from, const Segment& to, const MachineLimits& limits) {
    const double flat = std::hypot(to.direction[0], to.direction[1]);
    if (to.whole_arc) return std::sqrt(limits.printing * to.radius) / flat;
    if (from == nullptr || !(flat > 0)) return MachineLimits::kNone;
    const double flat_from = std::hypot(from->exit[0], from->exit[1]);
    if (!(flat_from > 0)) return MachineLimits::kNone;
    const double dot = (from->exit[0] * to.direction[0] + from->exit[1] * to.direction[1]) / (flat_from * flat);
    // Half of the difference of both unit vectors.
    const double sine_of_half = std::sqrt(std::max(0.5 * (1 - dot), 0.0));
    if (!(sine_of_half > 5e-6 && sine_of_half < 0.25)) return MachineLimits::kNone;
    return std::sqrt(limits.printing * 0.5 * to.length * flat / sine_of_half);
}

double cornerSpeed(const Segment& from, const Segment& to, const MachineLimits& limits) {
    switch (limits.rule) {
        case CornerRule::plan_jerk:
            return std::min(planJerkCorner(from, to, limits), to.speed);
        case CornerRule::reprap_jerk:
            return repRapCorner(from, to, limits);
        case CornerRule::bambu_jerk:
            return std::min(bambuCorner(from, to, limits), to.speed);
        default:
            return std::min(jerkCorner(from, to, limits), to.speed);
    }
}

}  // namespace stratum::motion
