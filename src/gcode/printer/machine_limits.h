// The machine's limits and the durations of tool changes, from a file's settings and from what the user says of the
// printer.
// Sources: the trailers and headers of PrusaSlicer, SuperSlicer, OrcaSlicer and BambuStudio ("; machine_max_jerk_x =
// 10,8": normal and silent mode). Cura's files state no limits: slicer/cura.h.
#pragma once

#include "gcode/printer/read_options.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::gcode {

constexpr double kLongestWait = 1e6;   // s
constexpr double kLongestAdvance = 5;  // s, of pressure advance

struct MachineSettings {
    MachineLimits limits;
    LimitOrigins origins;                ///< of these
    double most_printing = 0;            ///< mm/s^2 that M204 can't exceed; 0: no bound
    double most_travel = 0;              ///< mm/s^2, likewise
    bool feedrate_per_minute = false;    ///< M203 counts mm/min (RepRapFirmware, Sprinter)
    bool states_jerk = false;            ///< limits.jerk is from the file
    bool rule_chosen = false;            ///< limits.rule is fixed: commands don't change it
    std::vector<double> load;            ///< s by tool; may be short
    std::vector<double> unload;          ///< s by tool; may be short
    double change = 0;                   ///< s, of every change of tool
    double extruder_change = 0;          ///< s, of every change of extruder, where there are several
    std::vector<std::size_t> extruders;  ///< by filament, of a printer with several (Bambu's, filament_map); else empty
    bool parked = false;                 ///< filaments are, so that the first change unloads nothing (PrusaSlicer)
};

/// By what a slicer is known to plan its times, whatever the printer's own limits.
struct SlicerLimits {
    std::optional<MachineLimits> limits;  ///< with the rule; of its definition of the machine
    std::string machine;       ///< "definition of creality_ender3": where they are from; empty: no machine is named
    bool by_velocity = false;  ///< where it estimates by jerk: CornerRule::bambu_jerk
    bool ignores_settings = false;  ///< the machine_max_ lines that it writes don't count
};

/// Reads the comments at both ends of a program. Klipper reads none of a slicer's settings (machine_max_...): by its
/// rule they are taken for an assumption, each for the limit that is most like it.
/// @param rule      other than automatic: used unchanged
/// @param printer   its limits win over the settings
/// @param firmware  which the program is for; automatic: as the settings say
/// @param slicer    holds only where no printer is given
MachineSettings readMachineSettings(std::string_view bytes, CornerRule rule,
                                    const std::optional<PrinterLimits>& printer = {},
                                    Firmware firmware = Firmware::automatic, const SlicerLimits& slicer = {});

}  // namespace stratum::gcode
