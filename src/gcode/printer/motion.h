// Limits, moves and waits of a program: the input of a motion planner that computes real times and speeds.
//
// Moves are recorded only if ReadOptions::motion has a sink. The sink gets limits, moves and waits in program order, on
// the reading thread; nothing is stored here.
#pragma once

#include "gcode/toolpath/arc.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace stratum::gcode {

/// x, y, z and the extruder.
constexpr std::size_t kMotionAxes = 4;

/// The rule for the speed at the corner between two moves, and with it the planner of a firmware or of a slicer.
enum class CornerRule : std::uint8_t {
    automatic,           ///< chosen from the file and the printer: readMachineSettings()
    jerk,                ///< a jump of speed by axis (Marlin 1.1 and legacy, Prusa MK3)
    slicer_jerk,         ///< the same as PrusaSlicer and SuperSlicer estimate it
    plan_jerk,           ///< one jump of the speed's vector in the plane (Marlin 1.0, CuraEngine's estimate)
    junction_deviation,  ///< Marlin 2, Grbl
    corner_velocity,     ///< Klipper's square corner velocity
    marlin_jerk,         ///< a jump of speed by axis as Marlin 2 has it ("classic jerk")
    reprap_jerk,         ///< RepRapFirmware 3's jump of speed by axis (M566)
    programmed,          ///< no acceleration: Simplify3D's and Kiri:Moto's estimates
    bambu_jerk,          ///< a jump of the velocity, arcs in one piece: BambuStudio 2's and OrcaSlicer 2's estimate
};

/// The firmware whose way of dividing arcs into straight pieces is known.
enum class ArcRule : std::uint8_t { unknown, klipper, marlin, reprap };

/// Limits of the machine, mm, s. Limits of single axes and of the whole move hold together. Klipper's names in
/// parentheses: by its rule x and y have no limit of their own, and `printing` equals `travel`.
struct MachineLimits {
    static constexpr double kNone = std::numeric_limits<double>::infinity();
    /// By axis; infinite: none. z: max_z_velocity, max_z_accel. The defaults are PrusaSlicer's for an unknown machine.
    std::array<double, kMotionAxes> speed{500, 500, 12, 120};
    std::array<double, kMotionAxes> acceleration{9000, 9000, 500, 10000};
    std::array<double, kMotionAxes> jerk{10, 10, 0.2, 2.5};  ///< mm/s
    double printing = 1500;                                  ///< mm/s^2, of moves that extrude (max_accel)
    double travel = 1500;                                    ///< mm/s^2, of all others (max_accel)
    /// mm/s^2, of moves of E alone (max_extrude_only_accel: of E; also where it draws back)
    double retracting = 1500;
    double path_speed = kNone;          ///< mm/s along the path (max_velocity)
    double extrude_only_speed = kNone;  ///< mm/s of E in moves of E alone or that draw back (max_extrude_only_velocity)
    double least_printing_speed = 0;    ///< mm/s (M205 S)
    double least_travel_speed = 0;      ///< mm/s (M205 T)
    double junction_deviation = 0.013;  ///< mm; Marlin's default
    double corner_velocity = 5;         ///< mm/s (square_corner_velocity); Klipper's default
    double extruder_corner_velocity = 1;  ///< mm/s of E (instantaneous_corner_velocity); Klipper's default
    double cruise_ratio = 0.5;            ///< minimum_cruise_ratio; Klipper's older max_accel_to_decel is (1 - this) a
    double arc_resolution = 1;            ///< mm, of the pieces of an arc ([gcode_arcs] resolution)
    double wait_after_m400 = 0;           ///< s; until a host goes on once the machine has come to rest
    double pressure_advance = 0;          ///< s (M900 K, M572 S, SET_PRESSURE_ADVANCE); for flow, not for times
    std::array<double, kMotionAxes> steps_per_mm{};  ///< M92; 0: unknown
    CornerRule rule = CornerRule::jerk;
    ArcRule arcs = ArcRule::unknown;
    std::uint8_t jerk_policy = 0;  ///< RepRapFirmware's M566 P
    bool guessed = false;  ///< nobody states them: a slicer's for any machine, which its own times may tell better
};

/// A move, or one piece of a curve that beads can't represent.
struct Move {
    static constexpr std::uint32_t kNoBead = 0xffffffff;

    std::array<double, 3> start{};            ///< mm, in print space; of a machine with a belt, before it is tilted
    std::array<double, kMotionAxes> delta{};  ///< mm; E in mm of filament, flow factor (M221) included
    double speed = 0;                         ///< mm/s, programmed along the path, or of E if nothing else moves
    double filament_area = 0;                 ///< mm^2, section of the filament
    double sweep = 0;                         ///< radians; 0: straight
    PlanPoint center{};                       ///< mm from the start; of an arc
    std::uint32_t bead = kNoBead;             ///< index into Toolpath::beads of its bead, or kNoBead
    std::uint32_t line = 0;                   ///< 1-based line in the source
    std::uint32_t travel = kNoBead;           ///< index into the travels that are recorded (motion/travels.h), if any
};

/// What interrupts a print.
enum class Stop : std::uint8_t {
    tool_change,
    pause,            ///< M0, M1, M25, M226, M601, M400 U1, PAUSE
    filament_change,  ///< M600
};

class LimitOrigins;  // limit_origins.h

/// Receives a program's limits, moves and waits in program order.
class MotionSink {
public:
    MotionSink() = default;
    MotionSink(const MotionSink&) = delete;
    MotionSink& operator=(const MotionSink&) = delete;
    virtual ~MotionSink() = default;

    /// They hold from the next move on. Called once before anything else.
    virtual void limits(const MachineLimits& limits) = 0;
    virtual void move(const Move& move) = 0;
    /// The machine stops and waits for `seconds` (>= 0): G4, a change of tool, homing (its time is unknown: 0).
    virtual void wait(double seconds) = 0;
    /// What it is that the machine stops for, where people may want to know it; waits are told by themselves.
    virtual void stop(Stop kind, std::uint32_t line) { static_cast<void>(kind), static_cast<void>(line); }
    /// The slicer's own time of all before, s: Cura's ;TIME_ELAPSED, behind each layer.
    virtual void elapsed(double seconds) { static_cast<void>(seconds); }
    /// Once, at the end of the program: where the limits are from. Needed for reports only.
    virtual void origin(const LimitOrigins& origins) { static_cast<void>(origins); }
};

}  // namespace stratum::gcode
