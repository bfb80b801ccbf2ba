// Options of the reader: values that a file may not state, and callbacks.
#pragma once

#include "gcode/printer/limit_origins.h"
#include "gcode/printer/motion.h"
#include "gcode/toolpath/color.h"
#include "gcode/toolpath/frame.h"
#include "gcode/toolpath/toolpath.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace stratum::gcode {

/// The mode of E if neither the program nor its settings state it.
enum class ExtruderMode : std::uint8_t { automatic, absolute, relative };

/// The firmware whose rules apply where firmwares differ (G90/G91 change E's mode: Marlin yes, Klipper and
/// RepRapFirmware no).
enum class Firmware : std::uint8_t { automatic, marlin, klipper, reprap };

constexpr double kMostFlow = 1000;  ///< per cent

/// What a user says of the printer. Limits whose origin is `printer` or `firmware` win over the file's settings; the
/// commands of the program hold as far as the firmware reads them.
struct PrinterLimits {
    MachineLimits limits;  ///< rule automatic: as the file has it
    LimitOrigins origins;
    Firmware firmware = Firmware::automatic;  ///< automatic: not said
    std::string name;                         ///< of its file, for messages

    void set(Limit limit, double value, LimitOrigin::Kind kind, std::string place) {
        valueOf(limits, limit) = value;
        origins[limit] = {.kind = kind, .place = std::move(place)};
    }
};

struct ReadOptions {
    ExtruderMode extruder_mode = ExtruderMode::automatic;
    Firmware firmware = Firmware::automatic;
    std::vector<double> filament_diameters;  ///< mm by tool, the last one also beyond; overrides the file's settings
    /// By tool; override the file's settings where there is one. Changes of filament within the print stay.
    std::vector<std::optional<Rgb>> filament_colors;
    /// mm by tool: where nozzles are in the head, if the slicer has subtracted that; overrides the file's settings.
    std::vector<Point> tool_offsets;
    std::optional<double> layer_height;  ///< mm; used where it follows neither from tags nor from Z
    std::optional<int> plate;            ///< number of a program in a .gcode.3mf; needed only if it has several
    /// Degrees between gantry and belt, 5 to 85; Z of the program moves the belt. None: as the file states it, else a
    /// printer with a bed.
    std::optional<double> belt_angle;
    bool planar = false;           ///< programs that turn the part or the nozzle (A, B, C) are read by x, y and z alone
    MotionSink* motion = nullptr;  ///< receives all motion; nullptr: motion is not recorded
    CornerRule corner_rule = CornerRule::automatic;  ///< for `motion`
    std::optional<PrinterLimits> printer;
    DepositModel deposit;       ///< becomes Toolpath::deposit
    double flow_percent = 100;  ///< of all extrusion, besides M221: above 0, at most kMostFlow
    /// Called from time to time with the fraction done, 0..1, from the reading thread. May be empty.
    std::function<void(double)> progress;
};

}  // namespace stratum::gcode
