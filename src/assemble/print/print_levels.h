// G-code -> the fields that rays are traced through: no voxel is made before a ray comes to it.
#pragma once

#include "assemble/read_events.h"
#include "ondemand/print_field.h"
#include "shade/camera/pixel_size.h"
#include "voxelize/grid/print_options.h"

#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace stratum::assemble {

/// How to take a print.
struct PrintRequest {
    voxelize::PrintOptions print;
    std::string printed;          ///< one moment, as voxelize::parseSnapshots() reads it; empty: all of it
    bool timed = false;           ///< something wants to know when beads are laid
    int series = 1;               ///< of a growing print: as many moments, the last one the end
    bool series_by_time = false;  ///< equal times between them instead of equal volumes
    /// What a pixel spans of what lies in a box, mm, for print.voxel_auto; also the part's box, see
    /// voxelize::partBounds().
    std::function<shade::PixelSpread(const voxelize::Bounds& print, const voxelize::Bounds& part)> pixel_spread;
};

/// The print at one voxel size.
struct PrintLevel {
    std::shared_ptr<ondemand::PrintField> field;
    double from = 0;  ///< mm from PrintLevels::eye, as far as the next level's
};

/// A print that has been read.
struct PrintLevels {
    std::vector<PrintLevel> levels;        ///< from the nearest and finest outwards; the last one is of all beads
    glm::dvec3 eye{0.0};                   ///< mm; if there are several levels
    std::vector<std::uint32_t> moments;    ///< of the series: what lies before these beads is printed; the last is all
    std::vector<std::uint32_t> selection;  ///< indices of its beads, ascending
    std::shared_ptr<const gcode::Toolpath> toolpath;
    voxelize::Bounds part;          ///< mm, of its beads without what is printed beside the part
    std::string content;            ///< SHA-256 of the file, if asked for
    nlohmann::ordered_json report;  ///< path, counts and voxel sizes
    std::string line;               ///< the same in short, for people
    double parse_seconds = 0;
};

/// Reads G-code in any container; "-" is standard input. Throws InputError for what is no G-code, UsageError for
/// options that do not fit the print.
/// @param hash  fill in PrintLevels::content
PrintLevels readPrintLevels(const std::string& path, const PrintRequest& request, bool hash, const ReadEvents& events,
                            Warnings& warnings);

}  // namespace stratum::assemble
