// The command line of a print: which G-code, which of its beads, and what voxels. Shared by the tools that take prints.
#pragma once

#include "command_source.h"

#include "assemble/print/print_levels.h"
#include "voxelize/grid/print_options.h"

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace stratum::tools {

/// Declares them. With `pictures`, --voxel-size may be auto.
void addPrintOptions(CLI::App& app, bool pictures = false);

/// Reads them. Throws UsageError and InputError.
void readPrintOptions(CommandSource& options, voxelize::PrintOptions& print, bool pictures = false);

/// --printed, --progress-series and --by-time.
void addMomentOptions(CLI::App& app, assemble::PrintRequest& request);

/// Options on this command line that are of G-code alone, "--printed".
std::vector<std::string> givenPrintOptions(const CLI::App& app);

/// Throws UsageError if there are such options and the input, a level set, has no use for them.
void refusePrintOptions(const std::vector<std::string>& given, const std::string& vdb);

}  // namespace stratum::tools
