// The limits by which Cura plans the times that it writes: those of its definition of the machine, which a file names.
// Sources (facts only): resources/definitions/*.def.json of Cura 4.13 and 5 (machine_max_feedrate_*,
// machine_max_acceleration_*, machine_acceleration, machine_max_jerk_*); CuraEngine's timeEstimate.cpp.
#pragma once

#include "gcode/machine/motion.h"

#include <string_view>

namespace stratum::gcode {

/// Whether the name is a machine of the table; `machine` as TARGET_MACHINE.NAME or the id of a definition has it
/// ("Creality Ender-3", "creality_ender3").
bool isCuraMachine(std::string_view machine);

/// Limits of that machine; of fdmprinter, which all definitions build on, for any other name. The rule is plan_jerk.
MachineLimits curaLimits(std::string_view machine);

/// Replaces one limit by a changed setting ("machine_max_acceleration_x", "machine_acceleration"). False for other keys
/// and impossible values.
bool setCuraLimit(std::string_view key, std::string_view value, MachineLimits& limits);

}  // namespace stratum::gcode
