// The part of reports that is about how long a print takes.
#pragma once

#include "motion/print_times.h"

#include <nlohmann/json.hpp>

#include <string>
#include <string_view>

namespace stratum::tools {

/// Seconds that the slicer says the print takes: "; estimated printing time (normal mode) = 1h 2m 3s" of PrusaSlicer,
/// SuperSlicer and OrcaSlicer, BambuStudio's "; model printing time: 4m 48s; total estimated time: 11m 36s" (the first:
/// heating and calibration are in the second), Cura's ";TIME:451". 0 where the file says none, as Cura's engine does on
/// its own with 6666.
double statedSeconds(std::string_view gcode);

/// {planned_s, stated_s, rule, ...}; stated_s is null where the file is silent.
nlohmann::ordered_json describeTimes(const motion::PrintTimes& times, double stated);

/// The same as lines of text, each with its line end.
std::string timeLines(const motion::PrintTimes& times, double stated);

}  // namespace stratum::tools
