#include "motion/axis_limits.h"

#include <algorithm>
#include <cmath>

namespace stratum::motion {
namespace {

using gcode::CornerRule;
using gcode::MachineLimits;

constexpr double kFreeAcceleration = 99999999.9;  // mm/s^2: Klipper's for moves of E alone before the extruder's limit
constexpr double kSlowestRepRap = 0.5;            // mm/s: RepRapFirmware's least speed, unless an axis is slower

// The limits of single axes hold for the share that each has in the move.
void limitShares(const MachineLimits& limits, Segment& segment) {
    for (std::size_t axis = 0; axis < gcode::kMotionAxes; ++axis) {
        const double share = segment.share(axis);
        if (share * segment.speed > limits.speed[axis]) segment.speed = limits.speed[axis] / share;
        if (share * segment.acceleration > limits.acceleration[axis])
            segment.acceleration = limits.acceleration[axis] / share;
    }
}

void limitJerkRules(const MachineLimits& limits, Segment& segment) {
    const bool extrudes = segment.direction[3] != 0;
    segment.speed = std::max(segment.speed, extrudes ? limits.least_printing_speed : limits.least_travel_speed);
    if (segment.travels) segment.speed = std::min(segment.speed, limits.path_speed);
    segment.asked = segment.speed;
    segment.acceleration = !segment.travels ? limits.retracting : extrudes ? limits.printing : limits.travel;
    limitShares(limits, segment);
}

// X and Y have no limits of their own; those of Z hold for any move with z, those of the extruder for moves without x
// and y, and for all that retract.
void limitKlipper(const MachineLimits& limits, Segment& segment) {
    const auto limit = [&](double share, double speed, double acceleration) {
        segment.speed = std::min(segment.speed, speed / std::abs(share));
        segment.acceleration = std::min(segment.acceleration, acceleration / std::abs(share));
    };
    segment.acceleration = kFreeAcceleration;
    if (segment.travels) {
        segment.speed = std::min(segment.speed, limits.path_speed);
        segment.acceleration = limits.printing;
        if (const double z = segment.direction[2]; z != 0) limit(z, limits.speed[2], limits.acceleration[2]);
    }
    const double e = segment.direction[3];
    if (e < 0 || (e != 0 && segment.direction[0] == 0 && segment.direction[1] == 0))
        limit(e, limits.extrude_only_speed, limits.retracting);
}

void limitRepRap(const MachineLimits& limits, Segment& segment) {
    const bool in_plane = segment.direction[0] != 0 || segment.direction[1] != 0;
    MachineLimits own = limits;
    // Pressure advance makes the extruder jump by its factor times the acceleration.
    if (in_plane && segment.direction[3] != 0 && segment.pressure_advance > 0)
        own.acceleration[3] = std::min(own.acceleration[3], own.jerk[3] / segment.pressure_advance);
    segment.speed = std::max(segment.speed, std::max(kSlowestRepRap, limits.least_printing_speed));
    // M204 is for moves in x and y only.
    segment.acceleration = kFreeAcceleration;
    if (in_plane) segment.acceleration = segment.direction[3] > 0 ? limits.printing : limits.travel;
    limitShares(own, segment);
}

}  // namespace

void limitByAxes(const MachineLimits& limits, Segment& segment) {
    switch (limits.rule) {
        case CornerRule::corner_velocity:
            return limitKlipper(limits, segment);
        case CornerRule::reprap_jerk:
            return limitRepRap(limits, segment);
        default:
            return limitJerkRules(limits, segment);
    }
}

}  // namespace stratum::motion
