// Options that say which G-code, which of its beads, and what voxels: shared by the tools that take prints.
#pragma once

#include "gcode/reader.h"
#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/lattice.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxelizer.h"

#include <CLI/CLI.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::tools {

/// As the command line gives them; lists are parsed against a toolpath by the functions below.
struct PrintOptions {
    gcode::ReadOptions read;
    voxelize::LatticeRequest lattice;
    std::optional<double> tolerance;  ///< mm
    std::string memory_budget;
    bool voxel_auto = false;  ///< --voxel-size auto, of tools that make pictures
    std::string layers, features;
    std::vector<std::string> objects;  ///< names or numbers
};

/// Millimetres in a world unit by its name in files and on command lines, mm, cm or m; 1 for others, whose makers don't
/// say.
double millimetresIn(const std::string& unit);

/// The headings of options that are of prints alone.
inline constexpr const char* kLattice = "Lattice";
inline constexpr const char* kWhat = "What to convert";
inline constexpr const char* kReading = "Reading";

/// Adds them in those groups. With `pictures`, --voxel-size may be auto.
void addPrintOptions(CLI::App& app, PrintOptions& options, bool pictures = false);

/// What --layers, --features and --object keep of a print. Throws UsageError or InputError.
voxelize::Selection selectionOf(const PrintOptions& options, const gcode::Toolpath& toolpath);

/// What reading the file `name` warned of, on stderr.
void printWarnings(std::string_view tool, std::string_view name, const gcode::Toolpath& toolpath);

/// The selection in words, "layers 1:20; features -skirt"; empty if all is kept.
std::string describeSelection(const PrintOptions& options);

/// The lattice: --tolerance and --memory-budget become voxels a layer, and so does `pixel`, the least that a pixel
/// spans (mm), if the voxel size is to follow from the picture; everything else is the lattice's own choice. Where
/// fewer than two voxels a layer were asked for, its warning says what share of the beads that loses. Throws
/// UsageError.
voxelize::Lattice latticeFor(const PrintOptions& options, const gcode::Toolpath& toolpath,
                             const std::vector<std::uint32_t>& selection, const voxelize::Bounds& bounds,
                             voxelize::Interior interior, double pixel = 0);

}  // namespace stratum::tools
