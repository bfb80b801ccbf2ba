#include "motion/corner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace stratum::motion {
namespace {

using gcode::CornerRule;
using gcode::kMotionAxes;
using gcode::MachineLimits;

constexpr double kLeastPlannedSpeed = 0.05;    // mm/s: Marlin's MINIMUM_PLANNER_SPEED
constexpr double kStraight = 0.999999;         // cosine beyond which two directions are one, as in Marlin
constexpr double kExtruderCornerVelocity = 1;  // mm/s of E: Klipper's instantaneous_corner_velocity
constexpr double kPlainSpeed = 1e9;            // mm/s: no bound

// The change of speed by axis. An axis that reverses stops and starts: the larger of both counts, not their sum.
double axisJump(double before, double after) {
    if (before > after) return after > 0 || before < 0 ? before - after : std::max(before, -after);
    return after < 0 || before > 0 ? after - before : std::max(-before, after);
}

double jerkCorner(const Segment& from, const Segment& to, const MachineLimits& limits) {
    // The slicers' estimators use the programmed speed of the previous segment, not the limited one.
    const double speed_from = limits.rule == CornerRule::jerk ? from.speed : from.asked;
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

// The largest acceleration along a direction (of any length) within the limits of all axes.
double accelerationAlong(const std::array<double, kMotionAxes>& direction, double norm, double acceleration,
                         const MachineLimits& limits) {
    for (std::size_t axis = 0; axis < kMotionAxes; ++axis) {
        const double share = std::abs(direction[axis]) / norm;
        if (share * acceleration > limits.acceleration[axis]) acceleration = limits.acceleration[axis] / share;
    }
    return acceleration;
}

double deviationCorner(const Segment& from, const Segment& to, const MachineLimits& limits) {
    // Directions as they are in Marlin 2, E included, of unit length.
    double dot = 0;
    double norm_from = 0;
    double norm_to = 0;
    for (std::size_t axis = 0; axis < kMotionAxes; ++axis) {
        dot += from.direction[axis] * to.direction[axis];
        norm_from += from.direction[axis] * from.direction[axis];
        norm_to += to.direction[axis] * to.direction[axis];
    }
    const double cosine = -dot / std::sqrt(norm_from * norm_to);  // of the angle inside the corner
    const double slower = std::min(from.speed, to.speed);
    if (cosine > kStraight) return std::min(kLeastPlannedSpeed, slower);  // back the way it came
    if (cosine < -kStraight) return slower;
    std::array<double, kMotionAxes> across{};
    double norm = 0;
    for (std::size_t axis = 0; axis < kMotionAxes; ++axis) {
        across[axis] = to.direction[axis] / std::sqrt(norm_to) - from.direction[axis] / std::sqrt(norm_from);
        norm += across[axis] * across[axis];
    }
    const double acceleration = accelerationAlong(across, std::sqrt(norm), to.acceleration, limits);
    const double sine = std::sqrt(0.5 * (1 - cosine));  // of half the angle
    double squared = acceleration * limits.junction_deviation * sine / (1 - sine);
    // Short segments of a curve: the limit of their circle.
    if (to.length < 1 && cosine < -std::numbers::sqrt2 / 2)
        squared = std::min(squared, to.length * acceleration / std::acos(-cosine));
    return std::min(std::sqrt(squared), slower);
}

double velocityCorner(const Segment& from, const Segment& to, const MachineLimits& limits) {
    if (!from.travels || !to.travels) return 0;  // moves of E alone begin and end at rest
    const double slower = std::min(from.speed, to.speed);
    double squared = slower * slower;
    const double feed = std::abs(to.direction[3] - from.direction[3]);
    if (feed > 0) squared = std::min(squared, std::pow(kExtruderCornerVelocity / feed, 2));
    double dot = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) dot += from.direction[axis] * to.direction[axis];
    const double sine = std::sqrt(std::max(0.5 * (1 + dot), 0.0));  // of half the angle inside the corner
    const double cosine = std::sqrt(std::max(0.5 * (1 - dot), 0.0));
    if (!(sine < 1 && cosine > 0)) return std::sqrt(squared);
    // d a, with the a of the slower of the two: because of z it may be below the machine's.
    const double weaker = std::min({from.acceleration, to.acceleration, limits.printing}) / limits.printing;
    const double deviation = weaker * limits.corner_velocity * limits.corner_velocity * (std::numbers::sqrt2 - 1);
    squared = std::min(squared, deviation * sine / (1 - sine));
    const double quarter_tangent = 0.25 * sine / cosine;
    for (const Segment* segment : {&from, &to})
        squared = std::min(squared, 2 * segment->length * segment->acceleration * quarter_tangent);
    return std::sqrt(squared);
}

}  // namespace

double restSpeed(const Segment& segment, const MachineLimits& limits) {
    double speed = kPlainSpeed;
    switch (limits.rule) {
        case CornerRule::corner_velocity:
            return 0;
        case CornerRule::junction_deviation:
            return std::min(kLeastPlannedSpeed, segment.speed);
        case CornerRule::plan_jerk:
            // Half the change of speed, and for the slow axes only if theirs is larger.
            speed = limits.jerk[0] / 2;
            for (const std::size_t axis : {std::size_t{2}, std::size_t{3}})
                if (std::abs(segment.direction[axis]) * segment.speed > limits.jerk[axis] / 2)
                    speed = std::min(speed, limits.jerk[axis] / 2);
            break;
        case CornerRule::automatic:
        case CornerRule::jerk:
        case CornerRule::slicer_jerk:
            for (std::size_t axis = 0; axis < kMotionAxes; ++axis)
                if (std::abs(segment.direction[axis]) * segment.speed > limits.jerk[axis])
                    speed = std::min(speed, limits.jerk[axis]);
            break;
    }
    return std::min(speed, segment.speed);
}

double cornerSpeed(const Segment& from, const Segment& to, const MachineLimits& limits) {
    switch (limits.rule) {
        case CornerRule::plan_jerk:
            return std::min(planJerkCorner(from, to, limits), to.speed);
        case CornerRule::junction_deviation:
            return deviationCorner(from, to, limits);
        case CornerRule::corner_velocity:
            return velocityCorner(from, to, limits);
        default:
            return std::min(jerkCorner(from, to, limits), to.speed);
    }
}

}  // namespace stratum::motion
