// The part of reports that is about the limits of the machine: their values, and where each is from.
#pragma once

#include "gcode/printer/limit_origins.h"

#include <nlohmann/json.hpp>

#include <string>

namespace stratum::tools {

/// [{name, value, unit, from, changes, first_change}, ...] of the limits that the rule reads; a null value: no limit.
nlohmann::ordered_json describeLimits(const gcode::LimitOrigins& limits);

/// The same as lines of text, each with its line end. Axes whose limits are from one place share a line.
std::string limitLines(const gcode::LimitOrigins& limits);

}  // namespace stratum::tools
