// A straight segment of motion, with the limits of its axes applied: the planner's input.
#pragma once

#include "gcode/machine/motion.h"

#include <array>
#include <cstdint>
#include <functional>

namespace stratum::motion {

/// Arcs are divided into chords of about this length, mm, as in firmware (Marlin's MM_PER_ARC_SEGMENT): corner limits
/// apply between chords.
constexpr double kArcPiece = 1.0;

struct Segment {
    double length = 0;                                   ///< mm along the path; of E if nothing else moves; > 0
    double speed = 0;                                    ///< mm/s, within the limits of all axes; > 0
    double asked = 0;                                    ///< mm/s, programmed, before the axes' limits
    double acceleration = 0;                             ///< mm/s^2, likewise; > 0
    std::array<double, gcode::kMotionAxes> direction{};  ///< mm of each axis per mm of length
    double filament_area = 0;                            ///< mm^2, section of the filament
    double pressure_advance = 0;                         ///< s, in force
    bool travels = false;                                ///< x, y or z moves; else E alone
    bool curved = false;                                 ///< a chord of an arc
    std::uint32_t bead = gcode::Move::kNoBead;
    std::uint32_t line = 0;
};

/// Calls take() for the segments of a move, in order. A move of no length has none.
void cutMove(const gcode::Move& move, const gcode::MachineLimits& limits,
             const std::function<void(const Segment&)>& take);

}  // namespace stratum::motion
