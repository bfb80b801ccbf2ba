#include "conversion.h"

#include "grid_report.h"
#include "print_options.h"
#include "progress.h"
#include "time_report.h"
#include "toolpath_report.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/mapped_file.h"
#include "export/mesh_file.h"
#include "export/surface_mesh.h"
#include "export/usd_file.h"
#include "export/vdb_file.h"
#include "gcode/container/input_bytes.h"
#include "gcode/reader.h"
#include "gcode/slicer/bead_colors.h"
#include "gcode/summary.h"
#include "gcode/toolpath/toolpath_csv.h"
#include "gcode/toolpath/warning_log.h"
#include "motion/print_times.h"
#include "voxelize/beads/part_bounds.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/attributes.h"
#include "voxelize/grid/interior_distance.h"
#include "voxelize/grid/solid_check.h"
#include "voxelize/grid/voxelizer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace stratum::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

voxelize::Placement placementFor(const ConvertCommand& o, const voxelize::Bounds& bounds) {
    voxelize::Placement placement;
    placement.unit = 1 / voxelize::millimetresIn(o.unit);
    if (o.origin == "bed") return placement;
    for (int axis = 0; axis < 2; ++axis)
        placement.offset[axis] = o.origin == "center" ? -bounds.center(axis) : -bounds.min[axis];
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

std::vector<Job> planJobs(const ConvertCommand& o, const gcode::Toolpath& toolpath,
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
bool needsTimes(const ConvertCommand& o) {
    const std::vector<voxelize::Attribute> grids = voxelize::parseGrids(o.grids);
    const auto timed = [](voxelize::Attribute grid) {
        return grid == voxelize::Attribute::time || grid == voxelize::Attribute::speed;
    };
    return o.summary || !o.common.stats.empty() || voxelize::needsTiming(o.snapshots) ||
           std::any_of(grids.begin(), grids.end(), timed);
}

}  // namespace

fs::path usdaOf(fs::path vdb) { return vdb.replace_extension(".usda"); }

Json convert(const ConvertCommand& o, const std::string& input, const fs::path& output, RunFiles& files_of_run,
             int threads) {
    Stopwatch total;
    Stopwatch watch;
    // Unwritable places are found before the work, not after it.
    { const AtomicFile probe(output); }

    const gcode::InputBytes file(input);
    const std::string& name = file.name();
    motion::PrintTimes times;
    const bool planned = needsTimes(o);
    const gcode::Toolpath toolpath = [&] {
        gcode::ReadOptions read = o.print.read;
        ProgressBar bar("reading", o.common.quiet);
        read.progress = bar.callback();
        return planned ? motion::readTimedToolpath(file.bytes(), name, read, times)
                       : gcode::readToolpath(file.bytes(), name, read);
    }();
    const double parse_seconds = watch.lap();
    if (!o.common.quiet)
        for (const gcode::Warning& warning : toolpath.warnings)
            fmt::print(stderr, "gcode2vdb: {}\n", gcode::describe(warning, name));
    say(o.common, fmt::format("{}: {}, {} layers, {} beads ({} arcs), {:.2f} m of filament, {:.2f} cm3", name,
                              toolpath.slicer.empty() ? "unknown slicer" : toolpath.slicer, toolpath.layer_count,
                              toolpath.beads.size(), toolpath.arcs.size(), toolpath.filament_mm * 1e-3,
                              gcode::beadVolume(toolpath) * 1e-3));
    if (o.summary) say(o.common, gcode::summarize(toolpath) + timeLines(times, toolpath.stated));
    if (!o.dump_toolpath.empty()) gcode::writeToolpathCsv(toolpath, o.dump_toolpath);

    std::vector<std::uint32_t> selection = voxelize::selectBeads(toolpath, voxelize::selectionOf(o.print, toolpath));
    const std::size_t kept = selection.size();
    const voxelize::Bounds bounds = voxelize::boundsOf(toolpath, selection);
    const bool as_mesh = exporter::isMeshPath(output);
    const auto interior =
        o.interior == "cull" || (o.interior.empty() && as_mesh) ? voxelize::Interior::cull : voxelize::Interior::keep;
    std::vector<voxelize::Attribute> attributes = voxelize::parseGrids(o.grids);
    const std::vector<std::optional<gcode::Rgb>> colors = gcode::distinctColors(toolpath, selection);
    if (colors.size() > 1 && o.grids.empty() && !as_mesh) {
        attributes.push_back(voxelize::Attribute::color);
        say(o.common, fmt::format("  {} colors of filament: a color grid, too (--grids surface: none)", colors.size()));
    }
    const voxelize::Lattice lattice = voxelize::latticeFor(o.print, toolpath, selection, bounds, interior);
    say(o.common, fmt::format("  voxel {:g} mm ({}); {:.0f} % of the length lies on voxel planes", lattice.voxel_size,
                              lattice.reason, lattice.aligned_share * 100));
    if (!lattice.warning.empty() && !o.common.quiet) fmt::print(stderr, "gcode2vdb: {}: {}\n", name, lattice.warning);

    exporter::Provenance provenance;
    provenance.source_file = fs::path(name).filename().string();
    provenance.source_sha256 = sha256Hex(file.bytes());
    provenance.slicer = toolpath.slicer;
    provenance.unit = o.unit;
    provenance.up = o.up;
    provenance.selection = voxelize::describeSelection(o.print);
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
    std::optional<ProgressBar> bar;
    if (showsProgress(o.common.quiet))
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
            const ProgressNote note("distances", o.common.quiet);
            // The voxelizer goes on from its own values at the next step.
            grid = grid->deepCopy();
            voxelize::sweepInterior(*grid);
        }
        voxelize_seconds += watch.lap();
        cull_seconds += voxelizer.report().exterior_seconds;
        provenance.snapshot = job.label;
        std::optional<exporter::SurfaceMesh> mesh;
        if (as_mesh) {
            const auto* color = grids.empty() ? nullptr : openvdb::gridPtrCast<openvdb::Vec3SGrid>(grids.front()).get();
            {
                const ProgressNote note("meshing", o.common.quiet);
                mesh = exporter::meshSurface(*grid, {provenance.culled, o.mesh_error, color});
            }
            mesh_seconds += watch.lap();
            const ProgressNote note("writing", o.common.quiet);
            exporter::writeMesh(*mesh, job.path);
        } else {
            const auto printed = std::span<const std::uint32_t>(selection).first(job.beads);
            provenance.part = voxelize::placed(voxelize::partBounds(toolpath, printed), options.placement);
            const ProgressNote note("writing", o.common.quiet);
            exporter::describe(*grid, lattice, provenance);
            grids.insert(grids.begin(), grid);
            exporter::writeVdb(grids, job.path, o.file);
            if (o.usda) {
                exporter::writeUsda(grids, job.path, usdaOf(job.path),
                                    {0.001 * voxelize::millimetresIn(o.unit), o.up == "y"});
            }
        }
        write_seconds += watch.lap();
        const double deposited =
            voxelize::depositedVolume(toolpath, std::span<const std::uint32_t>(selection).first(job.beads));
        const double volume = [&] {
            const ProgressNote note("measuring", o.common.quiet);
            return enclosedMm3(*grid, lattice);
        }();
        const std::string doubt = doubtOf(volume, deposited, provenance.culled);
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
        if (mesh) files.back()["mesh"] = describeMesh(*mesh, *grid, lattice);
        say(o.common,
            fmt::format("  {}: {} active voxels, {} in memory, {} on disk", job.path.string(),
                        humanCount(static_cast<double>(grid->activeVoxelCount())),
                        humanBytes(static_cast<double>(grid->memUsage())), humanBytes(static_cast<double>(bytes))));
        if (mesh) say(o.common, fmt::format("  {} triangles", humanCount(static_cast<double>(mesh->triangleCount()))));
        if (!o.common.stats.empty() && job.label.empty()) {
            grid_report = describeGrid(*grid, lattice, volume, deposited);
            if (o.forecast && !provenance.culled) grid_report["cull_would_save"] = describeCull(voxelizer, *grid);
        }
    }
    Json skipped = Json::array();
    if (kept < toolpath.beads.size()) {
        const std::string why =
            provenance.selection.empty() ? "prime lines before layer 1 (--layers 0: keeps them)" : provenance.selection;
        const std::string count = fmt::format("{} of {} beads", toolpath.beads.size() - kept, toolpath.beads.size());
        skipped.push_back({{"what", "beads"}, {"why", why}, {"saved", count}});
        say(o.common, fmt::format("  left out {}: {}", count, why));
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
    Json toolpath_report = describeToolpath(toolpath);
    toolpath_report["selected_bbox_mm"] = {bounds.min, bounds.max};
    const double total_seconds = total.lap();
    say(o.common, fmt::format("  done in {:.2f} s", total_seconds));
    return {{"input",
             {{"path", input},
              {"bytes", file.bytes().size()},
              {"sha256", provenance.source_sha256},
              {"slicer", toolpath.slicer},
              {"format", toolpath.format}}},
            {"toolpath", toolpath_report},
            {"time", planned ? describeTimes(times, toolpath.stated) : Json(nullptr)},
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
            {"peak_rss_bytes", peakRssBytes()},
            {"threads", threads}};
}

}  // namespace stratum::tools
