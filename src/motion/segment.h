// A straight segment of motion: the planner's input.
#pragma once

#include "gcode/printer/motion.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace stratum::motion {

struct Segment {
    double length = 0;                                   ///< mm along the path; of E if nothing else moves; > 0
    double speed = 0;                                    ///< mm/s, within the machine's limits; > 0
    double asked = 0;                                    ///< mm/s, programmed
    double acceleration = 0;                             ///< mm/s^2, within the machine's limits; > 0
    std::array<double, 3> start{};                       ///< mm, as Move::start
    std::array<double, gcode::kMotionAxes> direction{};  ///< mm of each axis per mm of length
    double filament_area = 0;                            ///< mm^2, section of the filament
    double pressure_advance = 0;                         ///< s, in force
    double radius = 0;                                   ///< mm, of the arc that this is a chord of; 0: none
    double arc_rest = 0;                                 ///< mm of that arc after this chord
    bool whole_arc = false;                              ///< it is the arc: `direction` is at its start
    std::array<double, 2> exit{};                        ///< x and y of the direction at its end
    bool travels = false;                                ///< x, y or z moves; else E alone
    std::uint32_t bead = gcode::Move::kNoBead;
    std::uint32_t line = 0;
    std::uint32_t travel = gcode::Move::kNoBead;  ///< Move::travel

    /// Of the length, by axis; of a whole arc, x and y both have all that is in the plan.
    double share(std::size_t axis) const {
        return whole_arc && axis < 2 ? std::hypot(direction[0], direction[1]) : std::abs(direction[axis]);
    }
};

/// Calls take() for the segments of a move, in order; arcs are cut into chords as the rule's firmware does. Speed and
/// acceleration are still the programmed ones. A move of no length has none.
void cutMove(const gcode::Move& move, const gcode::MachineLimits& limits,
             const std::function<void(const Segment&)>& take);

}  // namespace stratum::motion
