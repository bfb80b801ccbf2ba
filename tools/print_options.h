// The command line of a print: which G-code, which of its beads, and what voxels. Shared by the tools that take prints.
#pragma once

#include "voxelize/grid/print_options.h"

#include <CLI/CLI.hpp>

namespace stratum::tools {

/// The headings of options that are of prints alone.
inline constexpr const char* kLattice = "Lattice";
inline constexpr const char* kWhat = "What to convert";
inline constexpr const char* kReading = "Reading";
inline constexpr const char* kPlastic = "Plastic";

/// Adds them in those groups. With `pictures`, --voxel-size may be auto.
void addPrintOptions(CLI::App& app, voxelize::PrintOptions& options, bool pictures = false);

}  // namespace stratum::tools
