// A straight piece of motion with the limits of its axes worked in: what a planner sees of a move.
#pragma once

#include "gcode/machine/motion.h"

#include <array>
#include <cstdint>
#include <functional>

namespace stratum::motion {

/// Firmwares run arcs as chords of about this length, mm (Marlin's MM_PER_ARC_SEGMENT), and so does the planner:
/// what a corner allows is decided from chord to chord.
constexpr double kArcPiece = 1.0;

struct Segment {
    double length = 0;                                   ///< mm along the path; of E if nothing else moves; > 0
    double speed = 0;                                    ///< mm/s, the fastest that every axis allows; > 0
    double asked = 0;                                    ///< mm/s, before the axes' limits
    double acceleration = 0;                             ///< mm/s^2, likewise; > 0
    std::array<double, gcode::kMotionAxes> direction{};  ///< mm of each axis in a mm of length
    bool travels = false;                                ///< x, y or z moves; else E alone
    std::uint32_t bead = gcode::Move::kNoBead;
    std::uint32_t line = 0;
};

/// The pieces of a move in order, each handed to `take`. A move that goes nowhere has none.
void cutMove(const gcode::Move& move, const gcode::MachineLimits& limits,
             const std::function<void(const Segment&)>& take);

}  // namespace stratum::motion
