// How a program is read: what its file leaves open, and who is told of it.
#pragma once

#include "gcode/machine/motion.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace stratum::gcode {

/// How E words count when the file and its settings leave it open.
enum class ExtruderMode : std::uint8_t { automatic, absolute, relative };

/// Whose rules hold where firmwares differ (does G90/G91 touch E: Marlin yes, Klipper and RepRapFirmware no).
enum class Firmware : std::uint8_t { automatic, marlin, klipper, reprap };

struct ReadOptions {
    ExtruderMode extruder_mode = ExtruderMode::automatic;
    Firmware firmware = Firmware::automatic;
    std::vector<double> filament_diameters;  ///< mm by tool, the last one also beyond; overrides the file's settings
    std::optional<double> layer_height;      ///< mm; used where neither tags nor Z moves tell
    std::optional<int> plate;                ///< which program of a .gcode.3mf; needed only if it has several
    MotionSink* motion = nullptr;            ///< is told everything that moves; nullptr: nobody asks
    CornerRule corner_rule = CornerRule::automatic;  ///< for `motion`
    /// Called now and then with the fraction done, 0..1, from the reading thread. May be empty.
    std::function<void(double)> progress;
};

}  // namespace stratum::gcode
