// The command line of vdbtrace: what it may hold, and how a scene file stands behind it.
#pragma once

#include "command_line.h"
#include "manual.h"
#include "trace_film_options.h"

#include "assemble/file/object_file.h"
#include "assemble/picture_request.h"
#include "shade/film/tonemap.h"
#include "shade/parts/shard.h"

#include <CLI/CLI.hpp>

#include <optional>
#include <string>
#include <vector>

namespace stratum::tools {

// What vdbtrace -h shows.

extern const char* const kTraceExamples;

Brief traceBrief();

/// --shard, and what follows from it (trace_shard.h).
struct ShardCommand {
    std::string text, by;  // as given
    bool resume = false;
    std::optional<shade::Shard> shard;
    bool pieces = false;              // traces a piece of each picture; else whole pictures
    std::vector<bool> made;           // which pictures are this process's; empty: all
    std::vector<std::string> scenes;  // hashes of what each picture is of, for pieces and resume
};

/// As the command line and a scene file give it.
struct TraceCommand : assemble::PictureRequest {
    CommonOptions common;
    std::vector<std::string> inputs;
    std::string output, write_brdf, checkpoint;
    bool each = false;
    std::string scene_file;  // or empty
    std::string scene_text;  // its hash
    std::string said;        // the options that are given, for checkpoints
    bool linear = false;     // the output keeps linear values: an .exr. Set when its name is checked
    std::string turns;       // --turntable, as given
    int turntable = 1;       // pictures of each camera
    assemble::HotEndLook nozzle;
    FilmCommand film;
    ShardCommand shard;
    std::vector<assemble::ObjectOptions> objects;  // of a scene file; empty: the inputs
    shade::ToneOptions tone;
};

/// Declares all options of vdbtrace, with its examples.
void addTraceOptions(CLI::App& app, TraceCommand& command);

/// Reads the scene, if the input is one, then the options of `app` over it, and checks all. Throws UsageError or
/// InputError.
void readPictureOptions(TraceCommand& command, const CLI::App& app);

/// Files that the options name, see assemble::inputFiles(). The inputs themselves are those of the objects, or beside
/// them.
std::vector<std::string> inputFilesOf(const TraceCommand& command);

/// A hash of what a picture is made from: those options, the input files (`files` says what they hold), and the files
/// that the options name.
std::string sourceOf(const TraceCommand& command, const std::string& files);

}  // namespace stratum::tools
