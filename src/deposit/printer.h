// What a printer makes of a program: presets of DepositModel and of the machine's limits.
#pragma once

#include "deposit/sag.h"
#include "gcode/printer/read_options.h"

#include <string>

namespace stratum::deposit {

/// Sets options.deposit from "ideal" (beads as commanded) or "typical", a model of a tuned printer with direct drive
/// (docs/deposit.md has the sources of its numbers); or options.printer from a file, told by its content: Klipper's
/// printer.cfg, RepRapFirmware's config.g, a report of Marlin's M503; or both from JSON (docs/printers.md has all of
/// them). Throws UsageError for an unknown name, InputError with the place for a file with unknown or impossible
/// values.
void usePrinter(const std::string& preset, gcode::ReadOptions& options);

/// Sets the corners of the section from "stadium", a radius in mm ("0.05"), or a percentage of half the height ("50%").
/// Throws UsageError.
void parseSection(const std::string& text, gcode::DepositModel& deposit);

constexpr double kLongestLag = 10;  ///< s, that a preset or a command line may say

}  // namespace stratum::deposit
