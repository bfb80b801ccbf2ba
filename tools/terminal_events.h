// What tools show of the files that it reads: steps on the terminal, warnings on stderr.
#pragma once

#include "assemble/file/read_events.h"

#include <string>

namespace stratum::tools {

/// Steps are lines of progress.h, if such lines are shown. `tool` begins the warnings. Quiet: no steps, and of warnings
/// only those of thin narrow bands.
assemble::ReadEvents terminalEvents(bool quiet, const std::string& tool = "vdbtrace");

}  // namespace stratum::tools
