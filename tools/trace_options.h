// The command line of vdbtrace: what it may hold, and how a scene file stands behind it.
#pragma once

#include "command_line.h"
#include "manual.h"
#include "trace_film_options.h"
#include "trace_print_options.h"

#include "assemble/file/object_file.h"
#include "march/brick/brick_layout.h"
#include "shade/film/tonemap.h"
#include "shade/integrator/render.h"
#include "shade/parts/shard.h"
#include "shade/scene/scene.h"
#include "trace/clip_intersector.h"

#include <CLI/CLI.hpp>

#include <map>
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
struct TraceCommand {
    CommonOptions common;
    std::vector<std::string> inputs, notes;
    std::string output, grid, file_up, bed_surface, march = "auto", size, view, crop, write_brdf, aov, normals;
    std::string eye, look_at, up, focus, phong;
    std::vector<std::string> clip;  // --clip, as given
    std::vector<trace::ClipPlane> clip_planes;
    bool each = false;
    std::string color, frame = "part";            // --color, --frame
    std::map<std::string, std::string> finishes;  // materials of --color's colors, see TracingOptions
    std::string scene_text;                       // hash of the scene file, or empty
    std::string said;                             // the options that are given, for checkpoints
    bool legend = false;
    std::string color_range;  // as given
    bool linear = false;      // the output keeps linear values: an .exr. Set when its name is checked
    std::string turns;        // --turntable, as given
    int turntable = 1;        // pictures of each camera
    assemble::HotEndLook nozzle;
    bool spp_given = false, exposure_given = false;
    std::optional<bool> denoise;  // empty: as fits the picture
    march::BrickValues values = march::BrickValues::Int16;
    assemble::PrintRequest prints;
    std::string brick_cache;  // as given; empty: no bound
    FilmCommand film;
    ShardCommand shard;
    std::vector<assemble::ObjectOptions> objects;  // of a scene file; empty: the inputs
    shade::SceneOptions scene;
    shade::RenderOptions render;
    shade::ToneOptions tone;
};

/// Declares all options of vdbtrace, with its examples.
void addTraceOptions(CLI::App& app, TraceCommand& command);

/// If the input is a scene, its values become the defaults and the command line is read once more over them. Throws
/// UsageError or InputError.
void readScene(TraceCommand& command, int argc, char** argv);

/// Files that the options name, see assemble::inputFiles(). The inputs themselves are those of the objects, or beside
/// them.
std::vector<std::string> inputFilesOf(const TraceCommand& command);

/// A hash of what a picture is made from: those options, the input files (`files` says what they hold), and the files
/// that the options name.
std::string sourceOf(const TraceCommand& command, const std::string& files);

/// Whether --color has a color a tool, which only prints have.
inline bool colorsTools(const TraceCommand& command) { return command.color.find(',') != std::string::npos; }

/// Parses the options that are kept as text, and checks all of them. Throws UsageError.
void applyText(TraceCommand& command);

}  // namespace stratum::tools
