// The part of reports that is about how long a print takes.
#pragma once

#include "gcode/toolpath/stated.h"
#include "motion/print_times.h"

#include <nlohmann/json.hpp>

#include <optional>
#include <string>

namespace stratum::tools {

/// {planned_s, stated_s, rule, limits, ...}; stated_s is the time of the printing alone where the slicer tells it
/// apart, and null where the file is silent. It is compared with `estimate`, if there is one: motion::estimatedTimes().
nlohmann::ordered_json describeTimes(const motion::PrintTimes& times, const std::optional<motion::PrintTimes>& estimate,
                                     const gcode::StatedFacts& stated);

/// The same as lines of text, each with its line end.
std::string timeLines(const motion::PrintTimes& times, const std::optional<motion::PrintTimes>& estimate,
                      const gcode::StatedFacts& stated);

}  // namespace stratum::tools
