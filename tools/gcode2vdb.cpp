// gcode2vdb: G-code -> level set of the part as printed.
#include "batch.h"
#include "choices.h"
#include "color_options.h"
#include "command_line.h"
#include "command_source.h"
#include "convert/conversion.h"
#include "convert/elements_output.h"
#include "convert/mesh_output.h"
#include "convert/model_comparison.h"
#include "convert/thumbnail_output.h"
#include "output_names.h"
#include "print_options.h"
#include "run_files.h"

#include "assemble/print/print_colors.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "export/mesh_file.h"
#include "export/nano_file.h"
#include "voxelize/grid/attributes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openvdb/openvdb.h>

#include <filesystem>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace {

using namespace stratum;
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kExamples = R"(
Examples:
  gcode2vdb part.gcode                        part.vdb, 4 voxels a layer
  gcode2vdb part.gcode -o part.vdb --voxel-size 0.1
  gcode2vdb part.gcode --voxels-per-layer 4 --features -skirt,-brim
  gcode2vdb part.gcode -o part.stl                  a closed mesh of the outside; also .ply, .obj
  gcode2vdb part.gcode -o part.glb --faces 50000    for a web page: no more triangles than that
  gcode2vdb part.gcode -o part.3mf --tool 0,1       with a material a tool; also .glb, .usda, .obj --grids color
  gcode2vdb part.gcode -o part.nvdb --precision half   NanoVDB for GPUs
  gcode2vdb part.gcode -o part.inp --voxel-size 0.4 --elastic 3500   solid elements for CalculiX and Abaqus
  gcode2vdb part.gcode -o part.glb --color 'Prusament Galaxy Black,#ffcc00'   a colour a tool
  gcode2vdb plate.gcode --object cube.stl           one object of several, by name or number
  gcode2vdb part.gcode --snapshots 25%,50%,75%      part_025pct.vdb, ..., three partial prints beside the whole one
  gcode2vdb part.gcode --unit m --origin center     for Blender; and --up y for Houdini
  gcode2vdb part.gcode --interior cull --voxel-size 0.05   only what is seen from outside
  gcode2vdb part.gcode --grids layer,color          what each voxel was printed as
  gcode2vdb part.gcode --compare part.stl --grids deviation   how far the print is from its model
  gcode2vdb plates.gcode.3mf --plate 2              one plate of several
  gcode2vdb part.gcode --report part.html --density 1.24    mass, porosity, walls, bonding ... as a page
  gcode2vdb part.gcode --thumbnail 300x300,16x16 -o new.gcode   the print with new pictures for the printer's screen
  zcat part.gcode.gz | gcode2vdb - -o part.vdb      from standard input
  gcode2vdb part.gcode --stats - --quiet            a JSON report on standard output)";

void addWritingOptions(CLI::App& app, tools::ConvertCommand& o) {
    const char* writing = "Writing";
    app.add_option_function<std::string>(
           "--precision", [&o](const std::string& text) { o.file.half = text == "half"; },
           "float or half; of a .nvdb half is Fp16, 16 bits over the range of each leaf (default float)")
        ->check(tools::oneOf({"float", "half"}))
        ->type_name("KIND")
        ->group(writing);
    const auto compression = [](exporter::Compression value) { return static_cast<int>(value); };
    app.add_option("--compression", o.file.compression, "blosc, zip or none (default blosc)")
        ->transform(tools::enumeration({{"blosc", compression(exporter::Compression::blosc)},
                                        {"zip", compression(exporter::Compression::zip)},
                                        {"none", compression(exporter::Compression::none)}}))
        ->type_name("KIND")
        ->group(writing);
    app.add_flag("--usda", o.usda, "Also a .usda beside each .vdb, with units, axes and its grids as fields")
        ->group(writing);
    app.add_option("--mesh-error", o.mesh_error, "Meshes: how far faces may be merged; 0 keeps all (default 0.25)")
        ->check(CLI::Range(0.0, 2.0))
        ->type_name("VOXELS")
        ->group(writing);
    app.add_option("--faces", o.mesh_faces, "Meshes: triangles at most; faces are merged as far as that takes")
        ->check(CLI::Range(100.0, 4e9))
        ->type_name("N")
        ->group(writing);
    app.add_flag("--forecast", o.forecast, "With --stats: what --interior cull would save")->group(writing);
    app.add_option("--dump-toolpath", o.dump_toolpath, "Write the beads as CSV")->type_name("FILE.csv")->group(writing);
    app.add_flag("--summary", o.summary, "Print what the file holds: layers, features, filament per tool")
        ->group(writing);
}

void addWhatOptions(CLI::App& app, tools::ConvertCommand& o) {
    const char* what = "What to convert";
    app.add_option(
           "--interior", o.interior,
           "keep all inner surfaces (the default for .vdb), or cull what no outside point can reach (for meshes)")
        ->check(tools::oneOf({"keep", "cull"}))
        ->type_name("HOW")
        ->group(what);
    app.add_flag("--interior-distance", o.interior_distance, "Signed distances inside too, to offset or simulate")
        ->group(what);
    const std::vector<std::string_view> grids = voxelize::attributeNames();
    std::vector<std::string> grid_words(grids.begin(), grids.end());
    grid_words.insert(grid_words.end(), {"surface", "deviation"});
    tools::completes(
        app.add_option("--grids", o.grids,
                       fmt::format("Grids of the same voxels: {}, deviation, or surface (default: color, if several)",
                                   fmt::join(grids, ", "))),
        tools::Completion::list, grid_words)
        ->type_name("LIST")
        ->group(what);
    app.add_option(
           "--color", o.color,
           "Colours of the tools, instead of those that the file states: '#ff6600', a name as in CSS, e.g. teal, "
           "or a real filament's, e.g. 'Prusament Galaxy Black'")
        ->type_name("COLOR,...")
        ->group(what);
    tools::addColorList(app, what);
    app.add_option("--snapshots", o.snapshots, "Partial prints too: 25%,layer:40,every:10,time:90")
        ->type_name("LIST")
        ->group(what);
}

void addOptions(CLI::App& app, tools::ConvertCommand& o) {
    app.add_option("IN", o.inputs,
                   "G-code of any slicer: text, .gz, .bgcode, .gcode.3mf, .ufp, .gx; - is standard input")
        ->required()
        ->type_name("FILE");
    app.add_option("-o,--output", o.output,
                   "A .vdb or .nvdb, or a mesh: .stl, .ply, .obj, .3mf, .glb, .usda, or solid elements: .inp; a "
                   "folder, made if missing, for the "
                   ".vdb files of several "
                   "inputs; - is a .vdb on standard output, -.stl a mesh (default: a .vdb named after the input, here; "
                   "of several inputs beside each)")
        ->type_name("FILE|DIR");
    tools::addPrintOptions(app);
    const char* lattice = "Lattice";
    app.add_option("--unit", o.unit, "World unit of the .vdb: mm, cm or m (default mm)")
        ->check(tools::oneOf({"mm", "cm", "m"}))
        ->type_name("UNIT")
        ->group(lattice);
    app.add_option("--origin", o.origin, "bed: as in the G-code; center: the part over the origin; min: its corner")
        ->check(tools::oneOf({"bed", "center", "min"}))
        ->type_name("WHERE")
        ->group(lattice);
    app.add_option("--up", o.up, "z as printed, or y for programs whose up is y")
        ->check(tools::oneOf({"z", "y"}))
        ->type_name("AXIS")
        ->group(lattice);
    addWhatOptions(app, o);
    addWritingOptions(app, o);
    tools::addCompareOptions(app, o.compare);
    tools::addElementOptions(app, o.elements);
    tools::addGone(app, "--shard", "one process writes the level set of a print of any size; leave it out");
    tools::addReportOptions(app, o.report);
    tools::addThumbnailOptions(app, o.thumbnail);
    tools::addCommonOptions(app, o.common,
                            {{"IN", "G-code of any slicer; - is standard input"},
                             {"--output", "A .vdb, .nvdb, mesh or .inp, or a folder"},
                             {"--voxel-size", ""},
                             {"--voxels-per-layer", ""},
                             {"--memory-budget", "Finest voxel that fits, e.g. 4GB"},
                             {"--unit", "World unit: mm, cm or m (default mm)"},
                             {"--origin", "bed, center or min (default bed)"},
                             {"--up", "z as printed, or y"},
                             {"--printer", "ideal, typical, or your printer's limits"},
                             {"--interior", "keep, or cull what nobody sees"},
                             {"--grids", "layer, feature, tool, width, color, ..."},
                             {"--layers", "Only layers A to B, counted from 1"},
                             {"--features", "+perimeter only, or all -skirt,-brim"},
                             {"--object", "Only this object of the print"},
                             {"--snapshots", "Partial prints: 25%,layer:40,time:90"},
                             {"--filament-diameter", "By tool; overrides the file's settings"},
                             {"--summary", "Layers, features, filament, time; no .vdb"},
                             {"--report", "Mass, porosity, walls: .json, .md, .html"},
                             {"--compare", "Distances to this model: .stl, .3mf, .obj"},
                             {"--thumbnail", "A copy of the print with new pictures"},
                             {"--threads", ""},
                             {"--stats", "Write a JSON report; - is standard output"},
                             {"--quiet", ""},
                             {"--version", "How it was built, and with what"},
                             {"--help", ""},
                             {"--help-all", ""}});
    app.footer(kExamples);
}

fs::path inFolder(const fs::path& folder, const std::string& input) { return folder / (tools::stemOf(input) + ".vdb"); }

// Where each input's output goes.
std::vector<fs::path> outputsOf(const tools::ConvertCommand& o) {
    const bool folder = o.inputs.size() > 1 || tools::namesFolder(o.output);
    std::vector<fs::path> outputs;
    for (const std::string& input : o.inputs)
        outputs.push_back(folder
                              ? inFolder(o.output.empty() ? fs::path(input).parent_path() : fs::path(o.output), input)
                          : o.output.empty() ? inFolder({}, input)
                                             : fs::path(o.output));
    return outputs;
}

// Options that one kind of output alone has.
void refuseUnused(const tools::CommandSource& options, const tools::ConvertCommand& o, const fs::path& output) {
    const bool mesh = exporter::isMeshPath(output);
    const auto refuse = [&](std::initializer_list<std::string_view> names, std::string_view what) {
        for (const std::string_view name : names)
            if (options.given(name))
                throw UsageError(fmt::format("{}: is for {}, not {}", options.called(name), what, output.string()));
    };
    if (!mesh) refuse({"mesh_error", "faces"}, "meshes: .stl, .ply, .obj, .3mf, .glb or .usda");
    if (mesh || tools::isElementsPath(output)) refuse({"precision", "compression", "usda"}, "volumes: a .vdb");
    if (exporter::isNanoPath(output)) refuse({"usda"}, "a .vdb");
    if (o.forecast && o.common.stats.empty()) throw UsageError("--forecast: is a part of the report; add --stats FILE");
    if (o.forecast && (mesh || tools::isElementsPath(output) || o.interior == "cull"))
        throw UsageError(
            "--forecast: is of a level set with all its inside, since meshes and --interior cull leave it out");
}

// What is asked of the output fits its kind. Before the work.
void check(const tools::CommandSource& options, const tools::ConvertCommand& o, const std::vector<fs::path>& outputs) {
    if (outputs.size() > 1) {
        std::error_code ignored;
        if (fs::path(o.output).has_extension() && !fs::is_directory(o.output, ignored) && !o.output.ends_with('/'))
            throw UsageError(fmt::format("-o {}: of {} inputs it names the folder of their .vdb files, e.g. -o voxels",
                                         o.output, outputs.size()));
        if (!o.dump_toolpath.empty()) throw UsageError("--dump-toolpath takes one input");
    }
    const fs::path& output = outputs.front();
    const bool mesh = exporter::isMeshPath(output);
    const bool standard = isStandardOutput(output);
    tools::checkElementOptions(o, output);
    const bool nano = exporter::isNanoPath(output);
    if (!mesh && !nano && !tools::isElementsPath(output) && output != "-" && output.extension() != ".vdb")
        throw UsageError(fmt::format(
            "-o {}: the name must end in .vdb, .nvdb, .stl, .ply, .obj, .3mf, .glb, .usda or .inp", output.string()));
    if (nano && standard)
        throw UsageError(fmt::format("-o {}: NanoVDB can't be a stream; name a file", output.string()));
    refuseUnused(options, o, output);
    if (o.compare.grid && (mesh || !o.writesGrid()))
        throw UsageError("--grids deviation: is a grid beside the surface; write a .vdb or .nvdb");
    if (mesh) tools::checkMeshGrids(o, output);
    if (standard && (o.usda || !o.snapshots.empty()))
        throw UsageError(fmt::format("{}: writes files beside the output; name one, -o {} is a stream",
                                     o.usda ? "--usda" : "--snapshots", output.string()));
}

// a/part.gcode and b/part.gcode would be one file in a folder.
void refuseEqualNames(const tools::ConvertCommand& o, const std::vector<fs::path>& outputs) {
    std::map<fs::path, std::string> sources;
    for (std::size_t n = 0; n < outputs.size(); ++n) {
        const auto [known, fresh] = sources.emplace(outputs[n], o.inputs[n]);
        if (!fresh)
            throw UsageError(fmt::format("{} and {} would both be {}; convert them one by one, with -o", known->second,
                                         o.inputs[n], outputs[n].string()));
    }
}

// One element a layer, if nobody chooses: a solver takes millions of elements, not billions.
void chooseElementSize(tools::ConvertCommand& o, const fs::path& output) {
    voxelize::PrintOptions& print = o.print;
    if (tools::isElementsPath(output) && !voxelize::choosesVoxels(print)) print.lattice.voxels_per_layer = 1;
}

void run(const tools::CommandSource& options, tools::ConvertCommand& o) {
    const std::vector<fs::path> outputs = outputsOf(o);
    o.compare.grid = tools::takeDeviation(o);
    check(options, o, outputs);
    chooseElementSize(o, outputs.front());
    const bool folder = !o.output.empty() && outputs.front() != o.output;
    refuseEqualNames(o, outputs);
    tools::RunFiles files;
    for (const std::string& input : o.inputs) files.reads(input);
    if (!o.compare.model.empty()) files.reads(o.compare.model);
    for (const fs::path& output : outputs) {
        if (o.writesGrid()) tools::noteOutput(o, output, o.output.empty() || outputs.size() > 1 ? "" : "-o", files);
        // USD ends a file's path there.
        if (o.usda && output.filename().string().find('@') != std::string::npos)
            throw UsageError(
                fmt::format("--usda: a .usda can't name a file with @ in it, {}; choose another -o", output.string()));
        if (o.usda) files.writes(tools::usdaOf(output).string(), "--usda");
    }
    files.writesBeside(o.dump_toolpath, "--dump-toolpath");
    files.writesBeside(o.common.stats, "--stats");
    tools::checkReport(o.report, o.inputs.size(), o.output, files);
    if (folder) tools::makeFolder(o.output);
    o.common.output_on_stdout =
        isStandardOutput(outputs.front()) || o.dump_toolpath == "-" || o.report.onStandardOutput();

    const tools::ThreadLimit limit(o.common.threads);
    openvdb::initialize();
    tools::Batch batch("gcode2vdb", o.inputs.size());
    Json reports = Json::array();
    for (std::size_t n = 0; n < o.inputs.size(); ++n)
        batch.attempt(o.inputs[n],
                      [&] { reports.push_back(tools::convert(o, o.inputs[n], outputs[n], files, limit.threads())); });
    for (const Json& failure : batch.failures()) reports.push_back(failure);
    tools::writeStats(o.common, o.inputs.size() == 1 ? reports.front() : reports);
    batch.finish();
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Turns printer G-code into a level set (.vdb) of the part as printed.", "gcode2vdb");
    tools::ConvertCommand options;
    addOptions(app, options);
    return tools::runTool(app, argc, argv, [&] {
        tools::CommandSource source(app);
        tools::readPrintOptions(source, options.print);
        if (!options.color.empty())
            options.print.read.filament_colors = assemble::toolColorsOf(options.color, "--color").colors;
        if (app.count("--thumbnail") > 0) {
            tools::keepFreedMemory();
            return tools::writeThumbnails(options);
        }
        tools::useHugePages(argv);
        if (!options.compare.model.empty()) tools::keepFreedMemory();  // of the level set, for polygons and their tree
        return run(source, options);
    });
}
