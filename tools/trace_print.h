// vdbtrace's way from G-code to rays: nothing is voxelized before a ray comes to it.
#pragma once

#include "print_options.h"

#include "ondemand/print_field.h"
#include "shade/camera/pixel_size.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace stratum::tools {

/// How to take a print.
struct TracePrintOptions {
    PrintOptions print;
    std::string printed;  ///< --printed: a cut as for --snapshots; empty: all of it
    bool timed = false;   ///< something wants to know when beads are laid
    bool series_by_time = false;
    int series = 1;             ///< --progress-series: as many moments, the last one the end
    std::string brick_cache;    ///< --brick-cache, also of large level sets; empty: no bound
    std::string brick_picture;  ///< --brick-picture: a file, or empty
    bool quiet = false;
    bool hash = false;  ///< fill in TracedPrint::content
    /// What a pixel spans of what lies in a box, mm, for --voxel-size auto; also the part's box, see
    /// voxelize::partBounds().
    std::function<shade::PixelSpread(const voxelize::Bounds& print, const voxelize::Bounds& part)> pixel_spread;
};

/// Adds those of a print: how to take it, what of it, and how to keep its bricks.
void addTracePrintOptions(CLI::App& app, TracePrintOptions& options);

/// The print at one voxel size.
struct TracedLevel {
    std::shared_ptr<ondemand::PrintField> field;
    double from = 0;  ///< mm from TracedPrint::eye, as far as the next level's
};

struct TracedPrint {
    std::vector<TracedLevel> levels;       ///< from the nearest and finest outwards; the last one is of all beads
    glm::dvec3 eye{0.0};                   ///< if there are several levels
    std::vector<std::uint32_t> moments;    ///< of the series: what lies before these beads is printed; the last is all
    std::vector<std::uint32_t> selection;  ///< its beads
    std::shared_ptr<const gcode::Toolpath> toolpath;
    voxelize::Bounds part;          ///< of its beads without what is printed beside the part
    std::string content;            ///< SHA-256 of the file, if asked for
    nlohmann::ordered_json report;  ///< for --stats
    std::string line;               ///< for people
    double parse_seconds = 0;
};

/// Whether a file holds an OpenVDB grid, by its first bytes; standard input ("-") doesn't. Throws InputError for one
/// that can't be read or is empty.
bool isVdbFile(const std::string& path);

/// Options on this command line that are of G-code alone, "--printed".
std::vector<std::string> givenPrintOptions(const CLI::App& app);

/// Throws UsageError if there are such options and the input, a level set, has no use for them.
void refusePrintOptions(const std::vector<std::string>& given, const std::string& vdb);

/// Reads G-code in any container. Throws InputError, UsageError.
TracedPrint readTracedPrint(const std::string& path, const TracePrintOptions& options);

}  // namespace stratum::tools
