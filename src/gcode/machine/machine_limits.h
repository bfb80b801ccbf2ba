// The machine's limits and the durations of tool changes, from a file's settings.
// Sources: the trailers and headers of PrusaSlicer, SuperSlicer, OrcaSlicer and BambuStudio ("; machine_max_jerk_x =
// 10,8": normal and silent mode); CuraEngine's defaults of fdmprinter.def.json, for its files state no limits.
#pragma once

#include "gcode/machine/motion.h"

#include <optional>
#include <string_view>
#include <vector>

namespace stratum::gcode {

/// Bounds of plausible limits: numbers beyond them are damaged.
constexpr double kFastestAxis = 1e5;      // mm/s
constexpr double kStrongestAxis = 1e7;    // mm/s^2
constexpr double kWeakestAxis = 1e-2;     // mm/s^2
constexpr double kLongestWait = 1e6;      // s
constexpr double kLongestDeviation = 10;  // mm, of a junction
constexpr double kLongestAdvance = 5;     // s, of pressure advance

struct MachineSettings {
    MachineLimits limits;
    double most_printing = 0;          ///< mm/s^2 that M204 can't exceed; 0: no bound
    double most_travel = 0;            ///< mm/s^2, likewise
    bool feedrate_per_minute = false;  ///< M203 counts mm/min (RepRapFirmware, Sprinter)
    bool states_jerk = false;          ///< limits.jerk is from the file
    bool rule_chosen = false;          ///< limits.rule is fixed: commands don't change it
    std::vector<double> load;          ///< s by tool; may be short
    std::vector<double> unload;        ///< s by tool; may be short
    double change = 0;                 ///< s, of every change of tool
};

/// Reads the comments at both ends of a program. A `rule` other than automatic is used unchanged. `defaults`, if given,
/// hold where the file states nothing.
MachineSettings readMachineSettings(std::string_view bytes, CornerRule rule,
                                    const std::optional<MachineLimits>& defaults = {});

}  // namespace stratum::gcode
