// G-code -> the fields that rays are traced through. Voxels are computed when a ray needs them.
#pragma once

#include "assemble/file/read_events.h"
#include "ondemand/print_field.h"
#include "shade/camera/pixel_size.h"
#include "trace/intersector.h"
#include "voxelize/beads/growth.h"
#include "voxelize/grid/print_options.h"

#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace stratum::assemble {

class KeptPrints;

/// How to read a print, and how much of it.
struct PrintRequest {
    voxelize::PrintOptions print;
    std::string printed;          ///< one moment, as voxelize::parseSnapshots() reads it; empty: all of it
    bool timed = false;           ///< print times of the beads are needed
    int series = 1;               ///< of a growing print: the number of moments; the last one is the end
    bool series_by_time = false;  ///< equal times between them instead of equal volumes
    /// A film's moments instead of a series: exactly these, of which some may be equal. Those of a series have each
    /// more beads than the one before. Both are of the selected beads.
    std::optional<voxelize::Growth> growth;
    /// The sizes of pixels on a print in the first box, mm, for print.voxel_auto and where no voxels are asked for;
    /// what else it gets is of the part alone. Null where the print does not stand alone, or the camera is not known.
    std::function<shade::PixelSpread(const voxelize::Bounds& print, const voxelize::Bounds& part,
                                     std::span<const glm::dvec3> outline)>
        pixel_spread;
    bool outline = false;  ///< PrintLevels::outline is needed
    /// Where prints are kept for the next scene of the same files; null: nothing is kept. Not with print.voxel_auto.
    KeptPrints* kept = nullptr;
    /// A program that is in memory already: then the objects' path is only a name. Its times are not computed.
    std::shared_ptr<const gcode::Toolpath> toolpath;
};

/// The print at one voxel size.
struct PrintLevel {
    std::shared_ptr<ondemand::PrintField> field;
    double from = 0;  ///< mm from PrintLevels::eye, up to the next level's
};

/// A print that has been read.
struct PrintLevels {
    std::vector<PrintLevel> levels;      ///< from the nearest and finest outwards; the last one is of all beads
    glm::dvec3 eye{0.0};                 ///< mm, world space; if there are several levels
    std::vector<std::uint32_t> moments;  ///< of the series: the beads before this index are printed; the last is all
    std::vector<glm::dvec3> tips;  ///< mm, world space, by moment: where the nozzle is when the last bead is finished
    std::vector<std::uint32_t> selection;  ///< indices of its beads, ascending
    std::shared_ptr<const gcode::Toolpath> toolpath;
    voxelize::Bounds part;            ///< mm, world space, of its beads without what is printed beside the part
    std::vector<glm::dvec3> outline;  ///< voxelize::partOutline(), world space; empty unless PrintRequest::outline
    std::string content;              ///< SHA-256 of the file, if asked for
    nlohmann::ordered_json report;    ///< path, counts and voxel sizes
    std::string line;                 ///< the same in short, for people
    double parse_seconds = 0;
};

/// The same box, mm, for the room that traces.
trace::Box boxOf(const voxelize::Bounds& bounds);

/// A program that has been read.
struct ReadProgram {
    std::shared_ptr<const gcode::Toolpath> toolpath;
    std::size_t bytes = 0;  ///< of the file
    std::string name;       ///< of the file, for messages
    std::string content;    ///< SHA-256, if it was asked for
};

/// Reads the G-code alone, in any container, or takes what request.kept has of it; times by bead only if the request
/// needs them. Throws InputError.
ReadProgram readProgram(const std::string& path, const PrintRequest& request, const ReadEvents& events,
                        Warnings& warnings, bool hash = false);

/// Reads G-code in any container; "-" is standard input. Throws InputError for what is no G-code, UsageError for
/// options that don't fit the print.
/// @param hash  fill in PrintLevels::content
PrintLevels readPrintLevels(const std::string& path, const PrintRequest& request, bool hash, const ReadEvents& events,
                            Warnings& warnings);

}  // namespace stratum::assemble
