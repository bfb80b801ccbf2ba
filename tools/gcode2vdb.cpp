// gcode2vdb: G-code -> level set of the part as printed.
#include "batch.h"
#include "choices.h"
#include "command_line.h"
#include "grid_report.h"
#include "output_names.h"
#include "print_options.h"
#include "progress.h"
#include "run_files.h"
#include "time_report.h"
#include "toolpath_report.h"

#include "gcode/bead_colors.h"
#include "gcode/input_bytes.h"
#include "gcode/reader.h"
#include "gcode/summary.h"
#include "gcode/toolpath_csv.h"
#include "io/atomic_file.h"
#include "io/error.h"
#include "io/mapped_file.h"
#include "motion/print_times.h"
#include "voxelize/attributes.h"
#include "voxelize/interior_distance.h"
#include "voxelize/mesh_file.h"
#include "voxelize/part_bounds.h"
#include "voxelize/selection.h"
#include "voxelize/solid_check.h"
#include "voxelize/surface_mesh.h"
#include "voxelize/usd_file.h"
#include "voxelize/vdb_file.h"
#include "voxelize/voxelizer.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace {

using namespace stratum;
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kExamples = R"(
Examples:
  gcode2vdb part.gcode                              part.vdb, voxel size chosen from the layer height
  gcode2vdb part.gcode -o part.vdb --voxel-size 0.1
  gcode2vdb part.gcode --voxels-per-layer 4 --features -skirt,-brim,-support
  gcode2vdb part.gcode -o part.stl                  a closed mesh of the outside; also .ply, .obj
  gcode2vdb plate.gcode --object cube.stl           one object of several, by name or number
  gcode2vdb part.gcode --snapshots 25%,50%,75%      part_025pct.vdb, ..., three partial prints beside the whole one
  gcode2vdb part.gcode --unit m --origin center     for Blender; and --up y for Houdini
  gcode2vdb part.gcode --interior cull --voxel-size 0.05   only what is seen from outside
  gcode2vdb part.gcode --grids layer,color          what each voxel was printed as
  gcode2vdb plates.gcode.3mf --plate 2              one plate of several
  zcat part.gcode.gz | gcode2vdb - -o part.vdb      from standard input
  gcode2vdb part.gcode --stats - --quiet            a JSON report on standard output)";

struct Options {
    tools::CommonOptions common;
    std::vector<std::string> inputs;
    std::string output;
    std::string dump_toolpath;
    bool summary = false;
    tools::PrintOptions print;
    std::string interior;  // empty: what the output wants
    double mesh_error = 0.25;
    bool forecast = false;
    bool interior_distance = false;
    bool usda = false;
    std::string grids;
    std::string up = "z";
    std::string snapshots;
    std::string unit = "mm", origin = "bed";
    voxelize::FileOptions file;
};

void addOptions(CLI::App& app, Options& o) {
    app.add_option("IN", o.inputs,
                   "G-code of any slicer: text, .gz, .bgcode, .gcode.3mf, .ufp, .gx; - is standard input")
        ->required()
        ->type_name("FILE");
    app.add_option("-o,--output", o.output,
                   "A .vdb, or a mesh: .stl, .ply, .obj; a folder, made if missing, for the .vdb files of several "
                   "inputs; - is a .vdb on standard output, -.stl a mesh (default: a .vdb named after the input, here; "
                   "of several inputs beside each)")
        ->type_name("FILE|DIR");
    tools::addPrintOptions(app, o.print);
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
    const char* what = "What to convert";
    app.add_option(
           "--interior", o.interior,
           "keep all inner surfaces (the default for .vdb), or cull what no outside point can reach (for meshes)")
        ->check(tools::oneOf({"keep", "cull"}))
        ->type_name("HOW")
        ->group(what);
    app.add_flag("--interior-distance", o.interior_distance, "Signed distances inside too, to offset or simulate")
        ->group(what);
    tools::completes(app.add_option("--grids", o.grids,
                                    "Also layer,time,feature,tool,object,width,speed,color, as grids of the same "
                                    "voxels; surface alone is no others (default: color if there are several)"),
                     tools::Completion::list,
                     {"surface", "layer", "time", "feature", "tool", "object", "width", "speed", "color"})
        ->type_name("LIST")
        ->group(what);
    app.add_option("--snapshots", o.snapshots, "Partial prints too: 25%,layer:40,every:10,time:90")
        ->type_name("LIST")
        ->group(what);
    const char* writing = "Writing";
    app.add_option_function<std::string>(
           "--precision", [&o](const std::string& text) { o.file.half = text == "half"; },
           "float or half (default float)")
        ->check(tools::oneOf({"float", "half"}))
        ->type_name("KIND")
        ->group(writing);
    const auto compression = [](voxelize::Compression value) { return static_cast<int>(value); };
    app.add_option("--compression", o.file.compression, "blosc, zip or none (default blosc)")
        ->transform(tools::enumeration({{"blosc", compression(voxelize::Compression::blosc)},
                                        {"zip", compression(voxelize::Compression::zip)},
                                        {"none", compression(voxelize::Compression::none)}}))
        ->type_name("KIND")
        ->group(writing);
    app.add_flag("--usda", o.usda, "Also a .usda beside each .vdb, with units, axes and its grids as fields")
        ->group(writing);
    app.add_option("--mesh-error", o.mesh_error, "Meshes: how far faces may be merged; 0 keeps all (default 0.25)")
        ->check(CLI::Range(0.0, 2.0))
        ->type_name("VOXELS")
        ->group(writing);
    app.add_flag("--forecast", o.forecast, "With --stats: what --interior cull would save")->group(writing);
    app.add_option("--dump-toolpath", o.dump_toolpath, "Write the beads as CSV")->type_name("FILE.csv")->group(writing);
    app.add_flag("--summary", o.summary, "Print what the file holds: layers, features, filament per tool")
        ->group(writing);
    tools::addCommonOptions(app, o.common,
                            {"--output",
                             "--voxel-size",
                             "--voxels-per-layer",
                             "--memory-budget",
                             "--unit",
                             "--origin",
                             "--up",
                             "--interior",
                             "--grids",
                             "--layers",
                             "--features",
                             "--object",
                             "--snapshots",
                             "--filament-diameter",
                             "--summary",
                             "--threads",
                             "--stats",
                             "--quiet",
                             "--version",
                             "--help",
                             "--help-all"});
    app.footer(kExamples);
}

voxelize::Placement placementFor(const Options& o, const voxelize::Bounds& bounds) {
    voxelize::Placement placement;
    placement.unit = 1 / tools::millimetresIn(o.unit);
    if (o.origin == "bed") return placement;
    for (int axis = 0; axis < 2; ++axis)
        placement.offset[axis] = o.origin == "center" ? -bounds.centre(axis) : -bounds.min[axis];
    placement.offset[2] = -bounds.min[2];
    return placement;
}

fs::path usdaOf(fs::path vdb) { return vdb.replace_extension(".usda"); }

// One output: the whole selection, or what of it a snapshot has printed.
struct Job {
    std::string label;
    fs::path path;
    std::size_t beads = 0;  // of the selection
    std::uint32_t end = 0;  // all selected beads before this one
};

std::vector<Job> planJobs(const Options& o, const gcode::Toolpath& toolpath,
                          const std::vector<std::uint32_t>& selection, const fs::path& output) {
    std::vector<Job> jobs;
    if (!o.snapshots.empty()) {
        for (const voxelize::Snapshot& snapshot : voxelize::parseSnapshots(o.snapshots, toolpath)) {
            fs::path path = output;
            path.replace_filename(
                fmt::format("{}_{}{}", output.stem().string(), snapshot.label, output.extension().string()));
            const auto end = static_cast<std::uint32_t>(snapshot.bead_count);
            const auto beads = std::lower_bound(selection.begin(), selection.end(), end) - selection.begin();
            if (beads > 0) jobs.push_back({snapshot.label, path, static_cast<std::size_t>(beads), end});
        }
    }
    jobs.push_back({"", output, selection.size(), static_cast<std::uint32_t>(toolpath.beads.size())});
    return jobs;
}

// Whether anything asks when beads are laid.
bool needsTimes(const Options& o) {
    const std::vector<voxelize::Attribute> grids = voxelize::parseGrids(o.grids);
    const auto timed = [](voxelize::Attribute grid) {
        return grid == voxelize::Attribute::time || grid == voxelize::Attribute::speed;
    };
    return o.summary || !o.common.stats.empty() || voxelize::needsTiming(o.snapshots) ||
           std::any_of(grids.begin(), grids.end(), timed);
}

Json convert(const Options& o, const std::string& input, const fs::path& output, tools::RunFiles& files_of_run,
             int threads) {
    tools::Stopwatch total;
    tools::Stopwatch watch;
    // Unwritable places are found before the work, not after it.
    { const AtomicFile probe(output); }

    const gcode::InputBytes file(input);
    const std::string& name = file.name();
    motion::PrintTimes times;
    const bool planned = needsTimes(o);
    const gcode::Toolpath toolpath = [&] {
        gcode::ReadOptions read = o.print.read;
        tools::ProgressBar bar("reading", o.common.quiet);
        read.progress = bar.callback();
        return planned ? motion::readTimedToolpath(file.bytes(), name, read, times)
                       : gcode::readToolpath(file.bytes(), name, read);
    }();
    const double parse_seconds = watch.lap();
    if (!o.common.quiet) tools::printWarnings("gcode2vdb", name, toolpath);
    tools::say(o.common, fmt::format("{}: {}, {} layers, {} beads ({} arcs), {:.2f} m of filament, {:.2f} cm3", name,
                                     toolpath.slicer.empty() ? "unknown slicer" : toolpath.slicer, toolpath.layer_count,
                                     toolpath.beads.size(), toolpath.arcs.size(), toolpath.filament_mm * 1e-3,
                                     gcode::beadVolume(toolpath) * 1e-3));
    if (o.summary) tools::say(o.common, gcode::summarize(toolpath) + tools::timeLines(times, toolpath.stated));
    if (!o.dump_toolpath.empty()) gcode::writeToolpathCsv(toolpath, o.dump_toolpath);

    std::vector<std::uint32_t> selection = voxelize::selectBeads(toolpath, tools::selectionOf(o.print, toolpath));
    const std::size_t kept = selection.size();
    const voxelize::Bounds bounds = voxelize::boundsOf(toolpath, selection);
    const bool as_mesh = voxelize::isMeshPath(output);
    const auto interior =
        o.interior == "cull" || (o.interior.empty() && as_mesh) ? voxelize::Interior::cull : voxelize::Interior::keep;
    std::vector<voxelize::Attribute> attributes = voxelize::parseGrids(o.grids);
    const std::vector<std::optional<gcode::Rgb>> colors = gcode::distinctColors(toolpath, selection);
    if (colors.size() > 1 && o.grids.empty() && !as_mesh) {
        attributes.push_back(voxelize::Attribute::color);
        tools::say(o.common,
                   fmt::format("  {} colors of filament: a color grid, too (--grids surface: none)", colors.size()));
    }
    const voxelize::Lattice lattice = tools::latticeFor(o.print, toolpath, selection, bounds, interior);
    tools::say(o.common, fmt::format("  voxel {:g} mm ({}); {:.0f} % of the length lies on voxel planes",
                                     lattice.voxel_size, lattice.reason, lattice.aligned_share * 100));
    if (!lattice.warning.empty() && !o.common.quiet) fmt::print(stderr, "gcode2vdb: {}: {}\n", name, lattice.warning);

    voxelize::Provenance provenance;
    provenance.source_file = fs::path(name).filename().string();
    provenance.source_sha256 = sha256Hex(file.bytes());
    provenance.slicer = toolpath.slicer;
    provenance.unit = o.unit;
    provenance.up = o.up;
    provenance.selection = tools::describeSelection(o.print);
    if (colors.size() == 1 && colors.front()) {
        const auto [red, green, blue] = *colors.front();
        provenance.filament_color = fmt::format("#{:02X}{:02X}{:02X}", red, green, blue);
    }
    provenance.culled = interior == voxelize::Interior::cull;
    provenance.swept = o.interior_distance;

    voxelize::VoxelizeOptions options;
    options.placement = placementFor(o, bounds);
    options.placement.up_y = o.up == "y";
    options.interior = interior;
    std::optional<tools::ProgressBar> bar;
    if (tools::showsProgress(o.common.quiet))
        options.progress = [&bar](double fraction) {
            if (bar) bar->show(fraction);
        };
    voxelize::Voxelizer voxelizer(toolpath, selection, lattice, options);
    double voxelize_seconds = watch.lap();
    double cull_seconds = 0;
    double mesh_seconds = 0;
    double write_seconds = 0;
    double check_seconds = 0;
    Json files = Json::array();
    Json grid_report;
    const std::vector<Job> jobs = planJobs(o, toolpath, selection, output);
    for (const Job& job : jobs)
        if (!job.label.empty()) {
            files_of_run.writes(job.path.string(), "--snapshots");
            if (o.usda) files_of_run.writes(usdaOf(job.path).string(), "--usda");
        }
    for (const Job& job : jobs) {
        watch.lap();
        bar.emplace("voxelizing", o.common.quiet);
        openvdb::FloatGrid::Ptr grid = voxelizer.printUntil(job.end);
        if (!attributes.empty()) bar.emplace("grids", o.common.quiet);
        openvdb::GridPtrVec grids = voxelizer.attributes(attributes);
        bar.reset();
        if (o.interior_distance) {
            const tools::ProgressNote note("distances", o.common.quiet);
            // The voxelizer goes on from its own values at the next step.
            grid = grid->deepCopy();
            voxelize::sweepInterior(*grid);
        }
        voxelize_seconds += watch.lap();
        cull_seconds += voxelizer.report().exterior_seconds;
        provenance.snapshot = job.label;
        std::optional<voxelize::SurfaceMesh> mesh;
        if (as_mesh) {
            const auto* color = grids.empty() ? nullptr : openvdb::gridPtrCast<openvdb::Vec3SGrid>(grids.front()).get();
            {
                const tools::ProgressNote note("meshing", o.common.quiet);
                mesh = voxelize::meshSurface(*grid, {provenance.culled, o.mesh_error, color});
            }
            mesh_seconds += watch.lap();
            const tools::ProgressNote note("writing", o.common.quiet);
            voxelize::writeMesh(*mesh, job.path);
        } else {
            const auto printed = std::span<const std::uint32_t>(selection).first(job.beads);
            provenance.part = voxelize::placed(voxelize::partBounds(toolpath, printed), options.placement);
            const tools::ProgressNote note("writing", o.common.quiet);
            voxelize::describe(*grid, lattice, provenance);
            grids.insert(grids.begin(), grid);
            voxelize::writeVdb(grids, job.path, o.file);
            if (o.usda) {
                voxelize::writeUsda(grids, job.path, usdaOf(job.path),
                                    {0.001 * tools::millimetresIn(o.unit), o.up == "y"});
            }
        }
        write_seconds += watch.lap();
        const double deposited =
            voxelize::depositedVolume(toolpath, std::span<const std::uint32_t>(selection).first(job.beads));
        const double volume = tools::enclosedMm3(*grid, lattice);
        const std::string doubt = tools::doubtOf(volume, deposited, provenance.culled);
        if (!doubt.empty() && !o.common.quiet) fmt::print(stderr, "gcode2vdb: {}: {}\n", name, doubt);
        check_seconds += watch.lap();
        const auto bytes = isStandardOutput(job.path) ? 0 : fs::file_size(job.path);
        files.push_back({{"path", job.path.string()},
                         {"snapshot", job.label},
                         {"bytes", bytes},
                         {"beads", job.beads},
                         {"active_voxels", grid->activeVoxelCount()},
                         {"leaves_evaluated", voxelizer.report().leaves_evaluated},
                         {"leaves_reused", voxelizer.report().leaves_reused}});
        if (mesh) files.back()["mesh"] = tools::describeMesh(*mesh, *grid, lattice);
        tools::say(o.common, fmt::format("  {}: {} active voxels, {} in memory, {} on disk", job.path.string(),
                                         tools::humanCount(static_cast<double>(grid->activeVoxelCount())),
                                         tools::humanBytes(static_cast<double>(grid->memUsage())),
                                         tools::humanBytes(static_cast<double>(bytes))));
        if (mesh)
            tools::say(o.common,
                       fmt::format("  {} triangles", tools::humanCount(static_cast<double>(mesh->triangleCount()))));
        if (!o.common.stats.empty() && job.label.empty()) {
            grid_report = tools::describeGrid(*grid, lattice, volume, deposited);
            if (o.forecast && !provenance.culled)
                grid_report["cull_would_save"] = tools::describeCull(voxelizer, *grid);
        }
    }
    Json skipped = Json::array();
    if (kept < toolpath.beads.size()) {
        const std::string why =
            provenance.selection.empty() ? "prime lines before layer 1 (--layers 0: keeps them)" : provenance.selection;
        const std::string count = fmt::format("{} of {} beads", toolpath.beads.size() - kept, toolpath.beads.size());
        skipped.push_back({{"what", "beads"}, {"why", why}, {"saved", count}});
        tools::say(o.common, fmt::format("  left out {}: {}", count, why));
    }
    if (!o.interior_distance)
        skipped.push_back({{"what", "distances inside the solid"},
                           {"why", "the surface needs only their sign"},
                           {"saved", "a fast-sweeping pass over the grid"}});
    if (attributes.empty())
        skipped.push_back({{"what", "attribute grids"},
                           {"why", "none asked for (--grids)"},
                           {"saved", "a nearest-bead search and four bytes a voxel for each"}});
    if (!o.forecast && !provenance.culled)
        skipped.push_back({{"what", "what --interior cull would save"},
                           {"why", "not asked for (--forecast)"},
                           {"saved", "a flood through all leaves, about a third of a build"}});
    if (provenance.culled) {
        const auto& report = voxelizer.report();
        skipped.push_back(
            {{"what", "leaves that the outside can't reach"},
             {"why", "--interior cull"},
             {"saved", fmt::format("{} of {} leaf positions were never evaluated",
                                   report.leaf_positions - report.leaves_evaluated, report.leaf_positions)}});
    }
    Json toolpath_report = tools::describeToolpath(toolpath);
    toolpath_report["selected_bbox_mm"] = {bounds.min, bounds.max};
    const double total_seconds = total.lap();
    tools::say(o.common, fmt::format("  done in {:.2f} s", total_seconds));
    return {{"input",
             {{"path", input},
              {"bytes", file.bytes().size()},
              {"sha256", provenance.source_sha256},
              {"slicer", toolpath.slicer},
              {"format", toolpath.format}}},
            {"toolpath", toolpath_report},
            {"time", planned ? tools::describeTimes(times, toolpath.stated) : Json(nullptr)},
            {"grid", grid_report},
            {"files", files},
            {"skipped", skipped},
            {"seconds",
             {{"parse", parse_seconds},
              {"cull", cull_seconds},
              {"voxelize", voxelize_seconds - cull_seconds},
              {"mesh", mesh_seconds},
              {"write", write_seconds},
              {"volume", check_seconds},
              {"total", total_seconds}}},
            {"peak_rss_bytes", tools::peakRssBytes()},
            {"threads", threads}};
}

fs::path inFolder(const fs::path& folder, const std::string& input) { return folder / (tools::stemOf(input) + ".vdb"); }

// Where each input's output goes.
std::vector<fs::path> outputsOf(const Options& o) {
    const bool folder = o.inputs.size() > 1 || tools::namesFolder(o.output);
    std::vector<fs::path> outputs;
    for (const std::string& input : o.inputs)
        outputs.push_back(folder
                              ? inFolder(o.output.empty() ? fs::path(input).parent_path() : fs::path(o.output), input)
                          : o.output.empty() ? inFolder({}, input)
                                             : fs::path(o.output));
    return outputs;
}

// A mesh has no voxels; a .ply can have the colors of its points.
void refuseGridsOfMeshes(const Options& o, const fs::path& output) {
    const auto grids = voxelize::parseGrids(o.grids);
    if (grids.empty()) return;
    const bool ply = voxelize::meshHasColors(output);
    if (!ply || grids.size() > 1 || grids.front() != voxelize::Attribute::color)
        throw UsageError(fmt::format("--grids {}: a mesh has no voxels; write a .vdb, not {}{}", o.grids,
                                     output.string(),
                                     ply ? ", or give --grids color" : ", or a .ply with --grids color"));
}

// What is asked of the output fits its kind. Before the work.
void check(const Options& o, const std::vector<fs::path>& outputs) {
    if (outputs.size() > 1) {
        std::error_code ignored;
        if (fs::path(o.output).has_extension() && !fs::is_directory(o.output, ignored) && !o.output.ends_with('/'))
            throw UsageError(fmt::format("-o {}: of {} inputs it names the folder of their .vdb files, e.g. -o voxels",
                                         o.output, outputs.size()));
        if (!o.dump_toolpath.empty()) throw UsageError("--dump-toolpath takes one input");
    }
    const fs::path& output = outputs.front();
    const bool mesh = voxelize::isMeshPath(output);
    const bool standard = isStandardOutput(output);
    if (!mesh && output != "-" && output.extension() != ".vdb")
        throw UsageError(fmt::format("-o {}: the name must end in .vdb, or .stl, .ply or .obj", output.string()));
    if (mesh && o.usda) throw UsageError(fmt::format("--usda: is for volumes; write a .vdb, not {}", output.string()));
    if (mesh) refuseGridsOfMeshes(o, output);
    if (standard && (o.usda || !o.snapshots.empty()))
        throw UsageError(fmt::format("{}: writes files beside the output; name one, -o {} is a stream",
                                     o.usda ? "--usda" : "--snapshots", output.string()));
}

void run(Options& o) {
    const std::vector<fs::path> outputs = outputsOf(o);
    check(o, outputs);
    tools::RunFiles files;
    for (const std::string& input : o.inputs) files.reads(input);
    for (const fs::path& output : outputs) {
        files.writes(output.string(), o.output.empty() || outputs.size() > 1 ? "" : "-o");
        if (o.usda) files.writes(usdaOf(output).string(), "--usda");
    }
    files.writes(o.dump_toolpath, "--dump-toolpath");
    files.writes(o.common.stats, "--stats");
    if (!o.output.empty() && outputs.front() != o.output) tools::makeFolder(o.output);
    o.common.output_on_stdout = isStandardOutput(outputs.front()) || o.dump_toolpath == "-";

    const tools::ThreadLimit limit(o.common.threads);
    openvdb::initialize();
    tools::Batch batch("gcode2vdb", o.inputs.size());
    Json reports = Json::array();
    for (std::size_t n = 0; n < o.inputs.size(); ++n)
        batch.attempt(o.inputs[n],
                      [&] { reports.push_back(convert(o, o.inputs[n], outputs[n], files, limit.threads())); });
    for (const Json& failure : batch.failures()) reports.push_back(failure);
    tools::writeStats(o.common, o.inputs.size() == 1 ? reports.front() : reports);
    batch.finish();
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Turns printer G-code into an OpenVDB level set of the part as printed, every bead and layer line.",
                 "gcode2vdb");
    Options options;
    addOptions(app, options);
    return tools::runTool(app, argc, argv, [&] {
        tools::useHugePages(argv);
        run(options);
    });
}
