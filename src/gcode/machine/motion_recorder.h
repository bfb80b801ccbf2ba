// Converts the commands and moves of the machine simulator into limits, moves and waits for a MotionSink.
// Sources: marlinfw.org/docs/gcode G004, M201, M203-M205, M207, M208; docs.duet3d.com M566; klipper3d.org/G-Codes.html
// SET_VELOCITY_LIMIT; Klipper's klippy/toolhead.py (of August 2026) for what it reads of M204, and that it has no M201,
// M203, M205 and M566; PrusaSlicer's GCodeProcessor for what M204 S and T mean in files of "Marlin (legacy)", and for
// G28 in its estimate.
#pragma once

#include "gcode/printer/machine_limits.h"
#include "gcode/printer/motion.h"
#include "gcode/text/lexer.h"
#include "gcode/toolpath/frame.h"
#include "gcode/toolpath/warning_log.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>

namespace stratum::gcode {

/// SET_VELOCITY_LIMIT's arguments.
struct VelocityLimit {
    std::optional<double> velocity;      ///< mm/s
    std::optional<double> acceleration;  ///< mm/s^2
    std::optional<double> cruise_ratio;
    std::optional<double> corner_velocity;  ///< mm/s
};

/// SET_RETRACTION's arguments.
struct RetractionChange {
    std::optional<double> length;          ///< mm
    std::optional<double> speed;           ///< mm/s
    std::optional<double> extra;           ///< mm, on top when it comes back
    std::optional<double> recovery_speed;  ///< mm/s
};

/// Impossible limits (negative, zero, beyond the bounds, no number) are ignored, with a warning.
class MotionRecorder {
public:
    /// The sink and the log must outlive it. `for_flow`: pressure advance matters, and what isn't understood of it is
    /// warned of.
    MotionRecorder(MotionSink& sink, MachineSettings settings, WarningLog& warnings, bool for_flow);

    /// A G or M command other than a move. `unit` is mm in a unit of the program.
    void command(const Command& command, double unit, std::uint32_t line);
    void velocityLimit(const VelocityLimit& limit, std::uint32_t line);
    void retraction(const RetractionChange& change);
    void changeTool(std::size_t from, std::size_t to, std::uint32_t line);
    void pause(std::uint32_t line) { sink_.stop(Stop::pause, line); }
    /// The printer does something by itself, which the program says how long.
    void wait(double seconds) { sink_.wait(std::clamp(seconds, 0.0, kLongestWait)); }
    void elapsed(double seconds) { sink_.elapsed(seconds); }
    /// `seconds`: as `what` has it in the file, M900 K or the like.
    void pressureAdvance(std::string_view what, double seconds, std::uint32_t line);

    /// A move in print space. `filament` is the movement of E in mm; `speed` is in mm/s, 0 if none was set yet.
    /// `filament_area`: its section, mm^2.
    void move(const Point& from, const Point& to, const std::optional<Arc>& arc, double filament, double filament_area,
              double speed, std::uint32_t bead, std::uint32_t line);

    /// The end of the program: tells the sink where the limits are from, and warns of those that nobody stated.
    void finish();

private:
    struct Retraction {
        double length = 0;  // mm
        double speed = 0;   // mm/s
    };

    void byAxis(const Command& command, Limit first, double scale, std::uint32_t line);
    void setAcceleration(const Command& command, double unit, std::uint32_t line);
    void setCorners(const Command& command, double unit, std::uint32_t line);
    void setRetraction(const Command& command, Retraction& retraction, double unit);
    void runRetraction(const Retraction& retraction, double sign, std::uint32_t line);
    /// As PrusaSlicer and its kin estimate it: a move to 0 at the speed of the last move.
    void home(const Command& command, std::uint32_t line);
    void dwell(const Command& command, std::uint32_t line);
    /// False if the value is impossible.
    bool take(Limit limit, std::string_view what, double value, std::uint32_t line);
    void change(Limit limit, double value, std::uint32_t line);
    /// A change of filament on a printer with several extruders, as Bambu Studio and OrcaSlicer estimate it: filament
    /// is unloaded and loaded only where the extruder had another.
    void changeFilament(std::size_t to, std::uint32_t line);
    bool isKlipper() const { return limits_.rule == CornerRule::corner_velocity; }
    void suggest(CornerRule rule);

    MotionSink& sink_;
    MachineSettings settings_;
    MachineLimits limits_;
    WarningLog& warnings_;
    bool for_flow_;
    double filament_area_ = 0;  // mm^2, of the last move
    Point place_;               // where it ended
    double speed_ = 0;          // mm/s, programmed of it
    Retraction retract_;
    Retraction recover_;
    bool retracted_ = false;
    bool changed_ = false;                          // the tool
    std::optional<std::size_t> extruder_;           // where there are several
    std::map<std::size_t, std::size_t> filaments_;  // in each of them
};

}  // namespace stratum::gcode
