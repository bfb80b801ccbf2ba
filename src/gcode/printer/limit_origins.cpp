#include "gcode/printer/limit_origins.h"

namespace stratum::gcode {
namespace {

struct Kind {
    std::string_view unit;
    Bounds bounds;
};

struct Facts {
    std::string_view plain;
    std::string_view klipper;  // empty: Klipper has no such limit
    Kind kind;
};

constexpr Kind kSpeed{"mm/s", {1e-3, 1e5}};
constexpr Kind kJump{"mm/s", {0, 1e5}};
constexpr Kind kAcceleration{"mm/s^2", {1e-2, 1e7}};
constexpr Kind kSteps{"steps/mm", {1e-3, 1e7}};

// In the order of Limit.
constexpr std::array<Facts, kLimitCount> kFacts{{
    {"speed x", "", kSpeed},
    {"speed y", "", kSpeed},
    {"speed z", "max_z_velocity", kSpeed},
    {"speed e", "", kSpeed},
    {"acceleration x", "", kAcceleration},
    {"acceleration y", "", kAcceleration},
    {"acceleration z", "max_z_accel", kAcceleration},
    {"acceleration e", "", kAcceleration},
    {"jerk x", "", kJump},
    {"jerk y", "", kJump},
    {"jerk z", "", kJump},
    {"jerk e", "", kJump},
    {"steps x", "", kSteps},
    {"steps y", "", kSteps},
    {"steps z", "", kSteps},
    {"steps e", "", kSteps},
    {"acceleration of printing", "max_accel", kAcceleration},
    {"acceleration of travel", "", kAcceleration},
    {"acceleration of retraction", "max_extrude_only_accel", kAcceleration},
    {"speed along the path", "max_velocity", kSpeed},
    {"speed of e alone", "max_extrude_only_velocity", kSpeed},
    {"least speed of printing", "", kJump},
    {"least speed of travel", "", kJump},
    {"junction deviation", "", {"mm", {1e-6, 10}}},
    {"corner velocity", "square_corner_velocity", kJump},
    {"corner velocity of e", "instantaneous_corner_velocity", kJump},
    {"cruise ratio", "minimum_cruise_ratio", {"", {0, 0.99}}},
    {"arc resolution", "resolution of arcs", {"mm", {1e-3, 100}}},
    {"wait after M400", "wait after M400", {"s", {0, 60}}},
}};

const Facts& factsOf(Limit limit) { return kFacts[static_cast<std::size_t>(limit)]; }

bool isOf(Limit limit, Limit first) { return limit >= first && limit < ofAxis(first, kMotionAxes); }

}  // namespace

double valueOf(const MachineLimits& limits, Limit limit) { return valueOf(const_cast<MachineLimits&>(limits), limit); }

double& valueOf(MachineLimits& limits, Limit limit) {
    const std::size_t axis = static_cast<std::size_t>(limit) % kMotionAxes;
    if (isOf(limit, Limit::speed)) return limits.speed[axis];
    if (isOf(limit, Limit::acceleration)) return limits.acceleration[axis];
    if (isOf(limit, Limit::jerk)) return limits.jerk[axis];
    if (isOf(limit, Limit::steps_per_mm)) return limits.steps_per_mm[axis];
    // In the order of Limit.
    using All = MachineLimits;
    constexpr std::array kOthers{&All::printing,           &All::travel,
                                 &All::retracting,         &All::path_speed,
                                 &All::extrude_only_speed, &All::least_printing_speed,
                                 &All::least_travel_speed, &All::junction_deviation,
                                 &All::corner_velocity,    &All::extruder_corner_velocity,
                                 &All::cruise_ratio,       &All::arc_resolution,
                                 &All::wait_after_m400};
    constexpr auto kFirst = static_cast<std::size_t>(Limit::printing);
    static_assert(kFirst + kOthers.size() == kLimitCount);
    return limits.*kOthers[static_cast<std::size_t>(limit) - kFirst];
}

std::string_view limitName(Limit limit, CornerRule rule) {
    const Facts& facts = factsOf(limit);
    return rule == CornerRule::corner_velocity && !facts.klipper.empty() ? facts.klipper : facts.plain;
}

std::string_view limitUnit(Limit limit) { return factsOf(limit).kind.unit; }

Bounds boundsOf(Limit limit) { return factsOf(limit).kind.bounds; }

bool isUsed(Limit limit, const LimitOrigins& origins) {
    const CornerRule rule = origins.rule;
    const LimitOrigin& origin = origins[limit];
    if ((limit == Limit::wait_after_m400 || isOf(limit, Limit::steps_per_mm)) && origin.value == 0 &&
        origin.changes == 0)
        return false;
    if (rule == CornerRule::programmed) return false;
    if (rule == CornerRule::corner_velocity) return !factsOf(limit).klipper.empty();
    if (isOf(limit, Limit::steps_per_mm))
        return rule == CornerRule::junction_deviation || rule == CornerRule::marlin_jerk;
    if (isOf(limit, Limit::jerk)) return rule != CornerRule::junction_deviation;
    switch (limit) {
        case Limit::junction_deviation:
            return rule == CornerRule::junction_deviation;
        case Limit::retracting:
            return rule != CornerRule::reprap_jerk;
        case Limit::path_speed:
        case Limit::extrude_only_speed:
        case Limit::corner_velocity:
        case Limit::extruder_corner_velocity:
        case Limit::cruise_ratio:
        case Limit::arc_resolution:
            return false;
        default:
            return true;
    }
}

}  // namespace stratum::gcode
