// One file of gcode2vdb, from G-code to the files that are made of it and its report.
#pragma once

#include "command_line.h"
#include "convert/convert_report.h"
#include "run_files.h"

#include "export/vdb_file.h"
#include "voxelize/grid/print_options.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace stratum::tools {

/// Of an .inp (elements_output.h).
struct ElementOptions {
    std::string elastic;  // empty: no material
    std::size_t most_nodes = 5'000'000;
    bool all_pieces = false;
};

/// --compare (model_comparison.h).
struct CompareCommand {
    std::string model;  // empty: none
    std::string placement = "fit";
    bool grid = false;  // --grids deviation
};

/// --thumbnail (thumbnail_output.h).
struct ThumbnailCommand {
    std::string sizes;  // empty: not asked for
    bool in_place = false;
};

/// As the command line gives it.
struct ConvertCommand {
    CommonOptions common;
    std::vector<std::string> inputs;
    std::string output;
    std::string dump_toolpath;
    bool summary = false;
    voxelize::PrintOptions print;
    std::string interior;  // empty: what the output wants
    double mesh_error = 0.25;
    std::size_t mesh_faces = 0;  // at most; 0: any number
    bool forecast = false;
    bool interior_distance = false;
    bool usda = false;
    std::string grids;
    std::string color;  // --color: as given
    std::string up = "z";
    std::string snapshots;
    std::string unit = "mm", origin = "bed";
    exporter::FileOptions file;
    ElementOptions elements;
    CompareCommand compare;
    ThumbnailCommand thumbnail;
    ConvertReport report;

    /// Whether a level set is written: not if only a report, a summary or a comparison is asked for.
    bool writesGrid() const {
        const bool tells = report.asked() || summary || !compare.model.empty();
        return !tells || !output.empty() || usda || !snapshots.empty() || !grids.empty() || compare.grid;
    }
    bool makesGrid() const { return writesGrid() || report.asked(); }
};

/// The .usda beside a .vdb.
std::filesystem::path usdaOf(std::filesystem::path vdb);

/// Converts one input, snapshots included. `files` learns what is written. Returns the report of --stats. Throws
/// InputError, UsageError, OutputError.
nlohmann::ordered_json convert(const ConvertCommand& command, const std::string& input,
                               const std::filesystem::path& output, RunFiles& files, int threads);

}  // namespace stratum::tools
