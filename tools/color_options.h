// The names of colours: --color of a tool's own kind, and --colors, which lists real filaments.
#pragma once

#include <CLI/CLI.hpp>

namespace stratum::tools {

/// --colors WORDS: prints the filaments that have these words in maker, material and name, and ends the tool.
void addColorList(CLI::App& app, const char* group);

}  // namespace stratum::tools
