// What a tool says about itself: -h, --help-all, its man page and its shell completion, all from the declared options.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <utility>
#include <vector>

namespace stratum::tools {

/// The options that -h shows, by name, with a line for each: with the option no more than 80 columns. An empty line
/// stands for the option's own description, which must be as short.
using Brief = std::vector<std::pair<std::string, std::string>>;

/// Adds --help-all, and the hidden --write-manual man|bash that the build calls. -h then shows the options of `brief`
/// (none: all of them) and the first three examples of the footer, on one screen of 80 columns.
void addManual(CLI::App& app, const Brief& brief = {});

/// A few lines for who calls a tool without any argument: what it does, how it is called, some examples.
std::string shortUsage(const CLI::App& app);

/// A page for man(1), section 1, in the man macros.
std::string manPage(const CLI::App& app);

/// A completion function for bash: options, their choices, subcommands, file names elsewhere.
std::string bashCompletion(const CLI::App& app);

}  // namespace stratum::tools
