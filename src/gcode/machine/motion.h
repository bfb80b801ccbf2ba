// What a program asks the machine to do, move by move: what a planner needs to find true times and speeds.
//
// Nobody records moves unless ReadOptions::motion names a sink. The sink sees limits, moves and waits in the order of
// the program, on the reading thread, and keeps what it wants; nothing is stored here.
#pragma once

#include "gcode/toolpath/arc.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace stratum::gcode {

/// x, y, z and the extruder.
constexpr std::size_t kMotionAxes = 4;

/// How fast a machine may go from one move into the next.
enum class CornerRule : std::uint8_t {
    automatic,           ///< as the file suggests: readMachineSettings()
    jerk,                ///< a jump of speed by axis (Marlin 1.1 and legacy)
    slicer_jerk,         ///< the same as PrusaSlicer, SuperSlicer, Orca and Bambu Studio estimate it
    plan_jerk,           ///< one jump of the speed's vector in the plane (Marlin 1.0, CuraEngine's estimate)
    junction_deviation,  ///< Marlin 2, Grbl
    corner_velocity,     ///< Klipper's square corner velocity
};

/// What the machine can do, mm, s. Limits of one axis and of the whole move hold together.
struct MachineLimits {
    /// By axis; infinite: none. The defaults are PrusaSlicer's for a machine of which nothing is known.
    std::array<double, kMotionAxes> speed{500, 500, 12, 120};
    std::array<double, kMotionAxes> acceleration{9000, 9000, 500, 10000};
    std::array<double, kMotionAxes> jerk{10, 10, 0.2, 2.5};       ///< mm/s
    double printing = 1500;                                       ///< mm/s^2, of moves that extrude
    double retracting = 1500;                                     ///< mm/s^2, of moves of E alone
    double travel = 1500;                                         ///< mm/s^2, of all others
    double path_speed = std::numeric_limits<double>::infinity();  ///< mm/s along the path (Klipper's max_velocity)
    double least_printing_speed = 0;                              ///< mm/s (M205 S)
    double least_travel_speed = 0;                                ///< mm/s (M205 T)
    double junction_deviation = 0.013;                            ///< mm; Marlin's default
    double corner_velocity = 5;                                   ///< mm/s; Klipper's default
    double cruise_ratio = 0.5;  ///< Klipper's minimum_cruise_ratio; its older max_accel_to_decel is (1 - this) a
    CornerRule rule = CornerRule::jerk;
};

/// A move, or, of curves that beads can't hold, one of its pieces.
struct Move {
    static constexpr std::uint32_t kNoBead = 0xffffffff;

    std::array<double, kMotionAxes> delta{};  ///< mm; E in mm of filament, flow factor (M221) included
    double speed = 0;                         ///< mm/s asked for along the path, or of E if nothing else moves
    double sweep = 0;                         ///< radians; 0: straight
    PlanPoint center{};                       ///< mm from the start; of an arc
    std::uint32_t bead = kNoBead;             ///< index into Toolpath::beads of what it lays, or kNoBead
    std::uint32_t line = 0;                   ///< 1-based line in the source
};

/// Takes what a program does, in its order.
class MotionSink {
public:
    MotionSink() = default;
    MotionSink(const MotionSink&) = delete;
    MotionSink& operator=(const MotionSink&) = delete;
    virtual ~MotionSink() = default;

    /// They hold from the next move on. Called once before anything else.
    virtual void limits(const MachineLimits& limits) = 0;
    virtual void move(const Move& move) = 0;
    /// Everything so far comes to rest, and `seconds` (>= 0) pass: G4, a change of tool, homing (which takes no time
    /// that a file could tell).
    virtual void wait(double seconds) = 0;
};

}  // namespace stratum::gcode
