// What a tool says about itself: -h, --help-all, its man page and its shell completion, all from the declared options.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace stratum::tools {

/// Adds --help-all, and the hidden --write-manual man|bash that the build calls. -h then shows only the options named
/// in `brief` (none: all of them) and the first three examples of the footer.
void addManual(CLI::App& app, const std::vector<std::string>& brief = {});

/// A few lines for who calls a tool without any argument: what it does, how it is called, some examples.
std::string shortUsage(const CLI::App& app);

/// A page for man(1), section 1, in the man macros.
std::string manPage(const CLI::App& app);

/// A completion function for bash: options, their choices, subcommands, file names elsewhere.
std::string bashCompletion(const CLI::App& app);

}  // namespace stratum::tools
