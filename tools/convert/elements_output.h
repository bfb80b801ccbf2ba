// -o part.inp: the solid voxels of a print as hexahedra for CalculiX and Abaqus.
#pragma once

#include "convert/conversion.h"

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/lattice.h"
#include "voxelize/beads/placement.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <span>

namespace stratum::tools {

/// Whether an output of this name is an input file of a solver: .inp, in any case.
bool isElementsPath(const std::filesystem::path& path);

void addElementOptions(CLI::App& app, ElementOptions& options);

/// Throws UsageError for options that ask for voxels or meshes, if the output is an .inp, or for elements, if it isn't.
void checkElementOptions(const ConvertCommand& command, const std::filesystem::path& output);

/// Makes the elements and writes them. Returns the entry of the report's "files". Throws UsageError, OutputError.
nlohmann::ordered_json writeElements(const ConvertCommand& command, const gcode::Toolpath& toolpath,
                                     std::span<const std::uint32_t> selection, const voxelize::Lattice& lattice,
                                     const voxelize::Placement& placement, const std::string& source,
                                     const std::filesystem::path& output);

}  // namespace stratum::tools
