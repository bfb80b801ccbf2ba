// What a printer makes of a program: presets of DepositModel and of the machine's limits.
#pragma once

#include "deposit/sag.h"
#include "gcode/machine/read_options.h"

#include <string>

namespace stratum::deposit {

/// Sets options.deposit, and the limits of motion if the preset has some, from "ideal" (beads as commanded), "typical",
/// or a JSON file (docs/deposit.md has its keys). "typical" is a model of a tuned printer with direct drive, with the
/// sources of its numbers there. Throws UsageError for an unknown name, InputError for a file with unknown or
/// impossible values, with its place.
void usePrinter(const std::string& preset, gcode::ReadOptions& options);

/// Sets the corners of the section from "stadium", a radius in mm ("0.05"), or a percentage of half the height ("50%").
/// Throws UsageError.
void parseSection(const std::string& text, gcode::DepositModel& deposit);

constexpr double kLongestLag = 10;  ///< s, that a preset or a command line may say

}  // namespace stratum::deposit
