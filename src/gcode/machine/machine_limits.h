// The machine's limits and the durations of tool changes, from a file's settings and from what the user says of the
// printer.
// Sources: the trailers and headers of PrusaSlicer, SuperSlicer, OrcaSlicer and BambuStudio ("; machine_max_jerk_x =
// 10,8": normal and silent mode); CuraEngine's defaults of fdmprinter.def.json, for its files state no limits.
#pragma once

#include "gcode/machine/read_options.h"

#include <optional>
#include <string_view>
#include <vector>

namespace stratum::gcode {

constexpr double kLongestWait = 1e6;   // s
constexpr double kLongestAdvance = 5;  // s, of pressure advance

struct MachineSettings {
    MachineLimits limits;
    LimitOrigins origins;              ///< of these
    double most_printing = 0;          ///< mm/s^2 that M204 can't exceed; 0: no bound
    double most_travel = 0;            ///< mm/s^2, likewise
    bool feedrate_per_minute = false;  ///< M203 counts mm/min (RepRapFirmware, Sprinter)
    bool states_jerk = false;          ///< limits.jerk is from the file
    bool rule_chosen = false;          ///< limits.rule is fixed: commands don't change it
    std::vector<double> load;          ///< s by tool; may be short
    std::vector<double> unload;        ///< s by tool; may be short
    double change = 0;                 ///< s, of every change of tool
};

/// Reads the comments at both ends of a program. Klipper reads none of a slicer's settings (machine_max_...): by its
/// rule they are taken for an assumption, each for the limit that is most like it.
/// @param rule      other than automatic: used unchanged
/// @param printer   its limits win over the settings
/// @param firmware  which the program is for; automatic: as the settings say
MachineSettings readMachineSettings(std::string_view bytes, CornerRule rule,
                                    const std::optional<PrinterLimits>& printer = {},
                                    Firmware firmware = Firmware::automatic);

}  // namespace stratum::gcode
