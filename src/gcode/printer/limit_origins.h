// The limits of MachineLimits one by one, and where each is from: for reports, and for what overrides what.
#pragma once

#include "gcode/printer/motion.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace stratum::gcode {

/// Of four in a row: x, y, z and the extruder.
enum class Limit : std::uint8_t {
    speed,
    acceleration = speed + kMotionAxes,
    jerk = acceleration + kMotionAxes,
    steps_per_mm = jerk + kMotionAxes,
    printing = steps_per_mm + kMotionAxes,
    travel,
    retracting,
    path_speed,
    extrude_only_speed,
    least_printing_speed,
    least_travel_speed,
    junction_deviation,
    corner_velocity,
    extruder_corner_velocity,
    cruise_ratio,
    arc_resolution,
    wait_after_m400,
};
constexpr std::size_t kLimitCount = static_cast<std::size_t>(Limit::wait_after_m400) + 1;

/// The limit of one axis, of the four that begin with `first`.
constexpr Limit ofAxis(Limit first, std::size_t axis) {
    return static_cast<Limit>(static_cast<std::size_t>(first) + axis);
}

double& valueOf(MachineLimits& limits, Limit limit);
double valueOf(const MachineLimits& limits, Limit limit);

/// As people know it: Klipper's option by Klipper's rule ("max_accel"), else plain words ("acceleration of travel").
std::string_view limitName(Limit limit, CornerRule rule);
std::string_view limitUnit(Limit limit);

struct Bounds {
    double least = 0;
    double most = 0;
};
/// Numbers beyond them are damaged, or of no machine.
Bounds boundsOf(Limit limit);

struct LimitOrigin {
    enum class Kind : std::uint8_t {
        assumed,   ///< stated nowhere
        setting,   ///< the slicer's, in a comment of the program
        firmware,  ///< the printer's file leaves it to the firmware's default
        printer,   ///< stated in the printer's file
        fitted,    ///< stated nowhere; what the times of the program's layers tell
    };
    Kind kind = Kind::assumed;
    std::string place;               ///< "printer.cfg:12", "machine_max_jerk_x"; empty if assumed
    double value = 0;                ///< as MachineLimits has it, before the program's first command
    std::uint32_t changes = 0;       ///< by commands of the program
    std::uint32_t first_change = 0;  ///< the line of the first; 0: none
};

class LimitOrigins {
public:
    CornerRule rule = CornerRule::automatic;  ///< of the planner, at the end of the program

    LimitOrigin& operator[](Limit limit) { return origins_[static_cast<std::size_t>(limit)]; }
    const LimitOrigin& operator[](Limit limit) const { return origins_[static_cast<std::size_t>(limit)]; }

private:
    std::array<LimitOrigin, kLimitCount> origins_;
};

/// Whether the planner reads the limit. Steps of motors and waits that nobody stated are left out: nothing is assumed.
bool isUsed(Limit limit, const LimitOrigins& origins);

}  // namespace stratum::gcode
