// Hexahedra -> an input file of CalculiX and Abaqus.
//
// Source: the keywords of both programs' manuals, and of these only what both read: CalculiX CrunchiX User's
// Manual 2.20, chapter 7; Abaqus Keywords Guide.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "mechanics/elastic.h"
#include "mechanics/hexahedra.h"
#include "mechanics/solid_elements.h"
#include "voxelize/beads/placement.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace stratum::mechanics {

struct InpOptions {
    std::optional<Elastic> elastic;  ///< without: no material and no section; the deck that includes the file has them
    voxelize::Placement placement;   ///< of mm, z up
    std::string source;              ///< the G-code file, for the heading
};

struct InpReport {
    std::size_t element_sets = 0, node_sets = 0;
    std::size_t directions = 0;  ///< sections of an orthotropic material; 0 without one
};

/// Units: mm, N, MPa. Elements are C3D8I: bricks with incompatible modes, which bend without locking. All are in the
/// set PART; sets as in element_sets.h; numbers count from 1. No step and no load: `*INCLUDE` the file in a deck that
/// has them. Throws UsageError if there are no elements, OutputError if it can't be written; the old file then stays.
InpReport writeInp(const SolidElements& elements, const Hexahedra& mesh, const gcode::Toolpath& toolpath,
                   const InpOptions& options, const std::filesystem::path& path);

}  // namespace stratum::mechanics
