#include "motion/corner.h"

#include <algorithm>
#include <cmath>

namespace stratum::motion {
namespace {

using gcode::CornerRule;
using gcode::kMotionAxes;
using gcode::MachineLimits;

double jerkCorner(const Segment& from, const Segment& to, const MachineLimits& limits) {
    // The slicers' estimators use the programmed speed of the previous segment, not the limited one.
    const double speed_from = limits.rule == CornerRule::slicer_jerk ? from.asked : from.speed;
    const double slower = std::min(speed_from, to.speed);
    const double safe_from = restSpeed(from, limits);
    const double safe_to = restSpeed(to, limits);
    // The corner is passed at the lower of the two speeds, but a faster successor may start with its own.
    const double before = speed_from > to.speed ? from.speed * to.speed / speed_from : from.speed;
    double factor = 1;
    for (std::size_t axis = 0; axis < kMotionAxes; ++axis) {
        const double jump = axisJump(from.direction[axis] * before * factor, to.direction[axis] * to.speed * factor);
        if (jump > limits.jerk[axis]) factor *= limits.jerk[axis] / jump;
    }
    const double speed = slower * factor;
    // A stop and a new start may be faster than the corner.
    return safe_from > 0.99 * speed && safe_to > 0.99 * speed ? safe_to : speed;
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
                if (std::abs(segment.direction[axis]) * segment.speed > limits.jerk[axis])
                    speed = std::min(speed, limits.jerk[axis]);
            return speed;
    }
}

double cornerSpeed(const Segment& from, const Segment& to, const MachineLimits& limits) {
    switch (limits.rule) {
        case CornerRule::plan_jerk:
            return std::min(planJerkCorner(from, to, limits), to.speed);
        case CornerRule::reprap_jerk:
            return repRapCorner(from, to, limits);
        default:
            return std::min(jerkCorner(from, to, limits), to.speed);
    }
}

}  // namespace stratum::motion
