// gcode2vdb: G-code -> level set of the part as printed.
#include "command_line.h"
#include "print_options.h"
#include "toolpath_report.h"

#include "gcode/input_bytes.h"
#include "gcode/reader.h"
#include "gcode/summary.h"
#include "gcode/toolpath_csv.h"
#include "io/atomic_file.h"
#include "io/error.h"
#include "io/mapped_file.h"
#include "voxelize/attributes.h"
#include "voxelize/enclosed_volume.h"
#include "voxelize/estimate.h"
#include "voxelize/interior_distance.h"
#include "voxelize/mesh_file.h"
#include "voxelize/part_bounds.h"
#include "voxelize/selection.h"
#include "voxelize/surface_mesh.h"
#include "voxelize/usd_file.h"
#include "voxelize/vdb_file.h"
#include "voxelize/voxelizer.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
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
  gcode2vdb part.gcode --snapshots 25%,50%,75%      three partial prints beside the whole one
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
    double adaptivity = 0.05;
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
                   "A .vdb, or a mesh: .stl, .ply, .obj; a folder for .vdb files if there are several inputs")
        ->type_name("FILE");
    tools::addPrintOptions(app, o.print);
    const char* lattice = "Lattice";
    app.add_option("--unit", o.unit, "World unit of the .vdb: mm, cm or m (default mm)")
        ->check(CLI::IsMember({"mm", "cm", "m"}))
        ->type_name("UNIT")
        ->group(lattice);
    app.add_option("--origin", o.origin, "bed: as in the G-code; center: the part over the origin; min: its corner")
        ->check(CLI::IsMember({"bed", "center", "min"}))
        ->type_name("WHERE")
        ->group(lattice);
    app.add_option("--up", o.up, "z as printed, or y for programs whose up is y")
        ->check(CLI::IsMember({"z", "y"}))
        ->type_name("AXIS")
        ->group(lattice);
    const char* what = "What to convert";
    app.add_option(
           "--interior", o.interior,
           "keep all inner surfaces (the default for .vdb), or cull what no outside point can reach (for meshes)")
        ->check(CLI::IsMember({"keep", "cull"}))
        ->type_name("HOW")
        ->group(what);
    app.add_flag("--interior-distance", o.interior_distance, "Signed distances inside too, to offset or simulate")
        ->group(what);
    app.add_option("--grids", o.grids,
                   "Also layer,time,feature,tool,object,width,speed,color, as grids of the same voxels")
        ->type_name("LIST")
        ->group(what);
    app.add_option("--snapshots", o.snapshots, "Partial prints too: 25%,layer:40,every:10,time:90")
        ->type_name("LIST")
        ->group(what);
    const char* writing = "Writing";
    app.add_option_function<std::string>(
           "--precision", [&o](const std::string& text) { o.file.half = text == "half"; },
           "float or half (default float)")
        ->check(CLI::IsMember({"float", "half"}))
        ->type_name("KIND")
        ->group(writing);
    const std::map<std::string, voxelize::Compression> compressions{{"blosc", voxelize::Compression::blosc},
                                                                    {"zip", voxelize::Compression::zip},
                                                                    {"none", voxelize::Compression::none}};
    app.add_option("--compression", o.file.compression, "blosc, zip or none (default blosc)")
        ->transform(CLI::CheckedTransformer(compressions).description(""))
        ->type_name("KIND")
        ->group(writing);
    app.add_flag("--usda", o.usda, "Also a .usda beside each .vdb, with units, axes and its grids as fields")
        ->group(writing);
    app.add_option("--adaptivity", o.adaptivity, "Meshes: 0 keeps all faces, 0.5 merges many (default 0.05)")
        ->check(CLI::Range(0.0, 0.5))
        ->type_name("A")
        ->group(writing);
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
                fmt::format("{}.{}{}", output.stem().string(), snapshot.label, output.extension().string()));
            const auto end = static_cast<std::uint32_t>(snapshot.bead_count);
            const auto beads = std::lower_bound(selection.begin(), selection.end(), end) - selection.begin();
            if (beads > 0) jobs.push_back({snapshot.label, path, static_cast<std::size_t>(beads), end});
        }
    }
    jobs.push_back({"", output, selection.size(), static_cast<std::uint32_t>(toolpath.beads.size())});
    return jobs;
}

Json describeGrid(const openvdb::FloatGrid& grid, const voxelize::Lattice& lattice) {
    const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
    const openvdb::Vec3d a = grid.indexToWorld(box.min());
    const openvdb::Vec3d b = grid.indexToWorld(box.max());
    const openvdb::Vec3d low = openvdb::math::minComponent(a, b);
    const openvdb::Vec3d high = openvdb::math::maxComponent(a, b);
    const double unit = grid.voxelSize()[0] / lattice.voxel_size;
    return {
        {"voxel_size_mm", lattice.voxel_size},
        {"half_width", lattice.half_width},
        {"layer_height_mm", lattice.layer_height},
        {"aligned_share", lattice.aligned_share},
        {"choice", lattice.reason},
        {"active_voxels", grid.activeVoxelCount()},
        {"leaves", grid.tree().leafCount()},
        {"bytes", grid.memUsage()},
        {"bbox_mm", {{low[0] / unit, low[1] / unit, low[2] / unit}, {high[0] / unit, high[1] / unit, high[2] / unit}}},
        {"volume_mm3", voxelize::enclosedVolume(grid) / (unit * unit * unit)}};
}

Json describeCull(const voxelize::Voxelizer& voxelizer, const openvdb::FloatGrid& grid) {
    const voxelize::CullForecast left = voxelizer.forecastCull();
    const std::size_t leaves = grid.tree().leafCount() - left.leaves;
    return {{"active_voxels", grid.activeVoxelCount() - left.active_voxels},
            {"leaves", leaves},
            {"bytes", leaves * static_cast<std::size_t>(voxelize::kBytesPerLeaf)}};
}

Json describeMesh(const voxelize::SurfaceMesh& mesh, const openvdb::FloatGrid& grid, const voxelize::Lattice& lattice) {
    const double unit = grid.voxelSize()[0] / lattice.voxel_size;
    return {{"vertices", mesh.points.size()},
            {"triangles", mesh.triangleCount()},
            {"volume_mm3", mesh.volume() / (unit * unit * unit)}};
}

Json convert(const Options& o, const std::string& input, const fs::path& output, int threads) {
    tools::Stopwatch total;
    tools::Stopwatch watch;
    // Unwritable places are found before the work, not after it.
    { const AtomicFile probe(output); }

    const gcode::InputBytes file(input);
    const std::string& name = file.name();
    gcode::ReadOptions read = o.print.read;
    tools::ProgressBar parse_bar("reading", o.common.quiet);
    read.progress = parse_bar.callback();
    const gcode::Toolpath toolpath = gcode::readToolpath(file.bytes(), name, read);
    const double parse_seconds = watch.lap();
    for (const gcode::Warning& warning : toolpath.warnings)
        if (!o.common.quiet)
            fmt::print(stderr, "gcode2vdb: {}:{}: {}{}\n", name, warning.first_line, warning.text,
                       warning.count > 1 ? fmt::format(" ({} times)", warning.count) : "");
    tools::say(o.common, fmt::format("{}: {}, {} layers, {} beads ({} arcs), {:.2f} m of filament, {:.2f} cm3", name,
                                     toolpath.slicer.empty() ? "unknown slicer" : toolpath.slicer, toolpath.layer_count,
                                     toolpath.beads.size(), toolpath.arcs.size(), toolpath.filament_mm * 1e-3,
                                     gcode::beadVolume(toolpath) * 1e-3));
    if (o.summary) tools::say(o.common, gcode::summarize(toolpath));
    if (!o.dump_toolpath.empty()) gcode::writeToolpathCsv(toolpath, o.dump_toolpath);

    std::vector<std::uint32_t> selection = voxelize::selectBeads(toolpath, tools::selectionOf(o.print, toolpath));
    const std::size_t kept = selection.size();
    const voxelize::Bounds bounds = voxelize::boundsOf(toolpath, selection);
    const bool as_mesh = voxelize::isMeshPath(output);
    const auto interior =
        o.interior == "cull" || (o.interior.empty() && as_mesh) ? voxelize::Interior::cull : voxelize::Interior::keep;
    const std::vector<voxelize::Attribute> attributes = voxelize::parseGrids(o.grids);
    const voxelize::Lattice lattice = tools::latticeFor(o.print, toolpath, selection, bounds, interior);
    tools::say(o.common, fmt::format("  voxel {:g} mm ({}); {:.0f} % of the length lies on voxel planes",
                                     lattice.voxel_size, lattice.reason, lattice.aligned_share * 100));

    voxelize::Provenance provenance;
    provenance.source_file = fs::path(name).filename().string();
    provenance.source_sha256 = sha256Hex(file.bytes());
    provenance.slicer = toolpath.slicer;
    provenance.unit = o.unit;
    provenance.up = o.up;
    provenance.selection = tools::describeSelection(o.print);
    provenance.culled = interior == voxelize::Interior::cull;
    provenance.swept = o.interior_distance;

    voxelize::VoxelizeOptions options;
    options.placement = placementFor(o, bounds);
    options.placement.up_y = o.up == "y";
    options.interior = interior;
    tools::ProgressBar bar("voxelizing", o.common.quiet);
    options.progress = bar.callback();
    voxelize::Voxelizer voxelizer(toolpath, selection, lattice, options);
    double voxelize_seconds = watch.lap();
    double cull_seconds = 0;
    double mesh_seconds = 0;
    double write_seconds = 0;
    Json files = Json::array();
    Json grid_report;
    for (const Job& job : planJobs(o, toolpath, selection, output)) {
        watch.lap();
        openvdb::FloatGrid::Ptr grid = voxelizer.printUntil(job.end);
        openvdb::GridPtrVec grids = voxelizer.attributes(attributes);
        if (o.interior_distance) {
            // The voxelizer goes on from its own values at the next step.
            grid = grid->deepCopy();
            voxelize::sweepInterior(*grid);
        }
        voxelize_seconds += watch.lap();
        cull_seconds += voxelizer.report().exterior_seconds;
        provenance.snapshot = job.label;
        std::optional<voxelize::SurfaceMesh> mesh;
        if (as_mesh) {
            mesh = voxelize::meshSurface(*grid, {provenance.culled, o.adaptivity});
            mesh_seconds += watch.lap();
            voxelize::writeMesh(*mesh, job.path);
        } else {
            const auto printed = std::span<const std::uint32_t>(selection).first(job.beads);
            provenance.part = voxelize::placed(voxelize::partBounds(toolpath, printed), options.placement);
            voxelize::describe(*grid, lattice, provenance);
            grids.insert(grids.begin(), grid);
            voxelize::writeVdb(grids, job.path, o.file);
            if (o.usda) {
                const fs::path scene = fs::path(job.path).replace_extension(".usda");
                voxelize::writeUsda(grids, job.path, scene, {0.001 * tools::millimetresIn(o.unit), o.up == "y"});
            }
        }
        write_seconds += watch.lap();
        const auto bytes = fs::file_size(job.path);
        files.push_back({{"path", job.path.string()},
                         {"snapshot", job.label},
                         {"bytes", bytes},
                         {"beads", job.beads},
                         {"active_voxels", grid->activeVoxelCount()},
                         {"leaves_evaluated", voxelizer.report().leaves_evaluated},
                         {"leaves_reused", voxelizer.report().leaves_reused}});
        if (mesh) files.back()["mesh"] = describeMesh(*mesh, *grid, lattice);
        tools::say(o.common, fmt::format("  {}: {} active voxels, {} in memory, {} on disk", job.path.string(),
                                         tools::humanCount(static_cast<double>(grid->activeVoxelCount())),
                                         tools::humanBytes(static_cast<double>(grid->memUsage())),
                                         tools::humanBytes(static_cast<double>(bytes))));
        if (mesh)
            tools::say(o.common,
                       fmt::format("  {} triangles", tools::humanCount(static_cast<double>(mesh->triangleCount()))));
        // Counting the enclosed volume reads every leaf once more: only for a report.
        if (!o.common.stats.empty() && job.label.empty()) {
            grid_report = describeGrid(*grid, lattice);
            if (!provenance.culled) grid_report["cull_would_save"] = describeCull(voxelizer, *grid);
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
            {"grid", grid_report},
            {"files", files},
            {"skipped", skipped},
            {"seconds",
             {{"parse", parse_seconds},
              {"cull", cull_seconds},
              {"voxelize", voxelize_seconds - cull_seconds},
              {"mesh", mesh_seconds},
              {"write", write_seconds},
              {"total", total_seconds}}},
            {"peak_rss_bytes", tools::peakRssBytes()},
            {"threads", threads}};
}

// part.gcode.gz and part.gcode.3mf -> part.vdb
fs::path outputName(const std::string& input) {
    if (input == "-") throw UsageError("standard input has no name to call the output by; give -o OUT.vdb");
    fs::path name = fs::path(input).filename();
    if (name.extension() == ".gz" || name.extension() == ".3mf") name = name.stem();
    return name.replace_extension(".vdb");
}

void run(const Options& o) {
    const tools::ThreadLimit limit(o.common.threads);
    openvdb::initialize();
    if (o.inputs.size() == 1) {
        fs::path output = o.output;
        if (output.empty()) output = outputName(o.inputs.front());
        const bool mesh = voxelize::isMeshPath(output);
        if (!mesh && output.extension() != ".vdb")
            throw UsageError(fmt::format("-o {}: the name must end in .vdb, or .stl, .ply or .obj", output.string()));
        if (mesh && o.usda)
            throw UsageError(fmt::format("--usda: is for volumes; write a .vdb, not {}", output.string()));
        if (mesh && !o.grids.empty())
            throw UsageError(fmt::format("--grids: a mesh has no voxels; write a .vdb, not {}", output.string()));
        tools::writeStats(o.common, convert(o, o.inputs.front(), output, limit.threads()));
        return;
    }
    if (!fs::is_directory(o.output))
        throw UsageError(
            fmt::format("{} inputs: -o must name an existing folder for their .vdb files", o.inputs.size()));
    if (!o.dump_toolpath.empty()) throw UsageError("--dump-toolpath takes one input");
    Json reports = Json::array();
    for (const std::string& input : o.inputs)
        reports.push_back(convert(o, input, fs::path(o.output) / outputName(input), limit.threads()));
    tools::writeStats(o.common, reports);
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
