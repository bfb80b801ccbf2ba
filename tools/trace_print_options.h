// The command line of vdbtrace for prints: how to take one, what of it, and how to keep its bricks.
#pragma once

#include "assemble/print/print_levels.h"

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace stratum::tools {

/// `brick_cache`: --brick-cache, also of large level sets; empty: no bound.
void addTracePrintOptions(CLI::App& app, assemble::PrintRequest& request, std::string& brick_cache);

/// Options on this command line that are of G-code alone, "--printed".
std::vector<std::string> givenPrintOptions(const CLI::App& app);

/// Throws UsageError if there are such options and the input, a level set, has no use for them.
void refusePrintOptions(const std::vector<std::string>& given, const std::string& vdb);

}  // namespace stratum::tools
