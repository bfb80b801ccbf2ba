#include "trace_print.h"

#include "command_line.h"
#include "progress.h"

#include "base/error.h"
#include "base/mapped_file.h"
#include "gcode/container/input_bytes.h"
#include "gcode/reader.h"
#include "motion/print_times.h"
#include "ondemand/detail_levels.h"
#include "voxelize/beads/part_bounds.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxel_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <string_view>
#include <utility>
#include <vector>

namespace stratum::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kVdbMagic = " BDV";

// Those of the selection that are printed by then.
void cut(std::vector<std::uint32_t>& selection, const std::string& printed, const gcode::Toolpath& toolpath) {
    const std::vector<voxelize::Snapshot> cuts = voxelize::parseSnapshots(printed, toolpath, "--printed");
    if (cuts.size() != 1)
        throw UsageError(
            fmt::format("--printed {}: expected one moment, e.g. 50%, layer:40, time:90 or time:50%", printed));
    const auto last = std::lower_bound(selection.begin(), selection.end(), cuts.front().bead_count);
    selection.erase(last, selection.end());
    if (selection.empty())
        throw UsageError(fmt::format("--printed {}: nothing of what is selected is printed by then", printed));
}

// Equal steps of the extruded volume, or of time; the last one is all. Prints of few beads have fewer.
std::vector<std::uint32_t> momentsOf(int series, bool by_time, const gcode::Toolpath& toolpath) {
    std::vector<std::uint32_t> moments;
    std::string steps;
    for (int n = 1; n < series; ++n)
        steps += fmt::format("{}{}{:.9g}%", n > 1 ? "," : "", by_time ? "time:" : "", 100.0 * n / series);
    if (!steps.empty())
        for (const voxelize::Snapshot& step : voxelize::parseSnapshots(steps, toolpath))
            moments.push_back(static_cast<std::uint32_t>(step.bead_count));
    moments.push_back(static_cast<std::uint32_t>(toolpath.beads.size()));
    return moments;
}

/// What all fields of one print are made from.
struct Source {
    const TracePrintOptions& options;
    const std::shared_ptr<const gcode::Toolpath>& toolpath;
    const std::vector<std::uint32_t>& selection;
    const voxelize::Bounds& bounds;
    const std::string& path;
};

// Far from an eye that is close to the print it is seen small: what voxels it takes there. The first level has the
// lattice that is given.
std::vector<voxelize::Lattice> latticesOf(const Source& source, const voxelize::Lattice& finest,
                                          const std::vector<ondemand::VoxelLevel>& levels) {
    std::vector<voxelize::Lattice> lattices{finest};
    voxelize::LatticeRequest request = source.options.print.lattice;
    for (std::size_t n = 1; n < levels.size(); ++n) {
        request.voxels_per_layer = levels[n].voxels_per_layer;
        lattices.push_back(voxelize::chooseLattice(*source.toolpath, source.selection, source.bounds, request));
    }
    return lattices;
}

// Each of the beads that its lattice can show: those that reach its shell, with the band around it and what samples'
// neighbours need. Levels that no bead comes to are left out.
std::vector<TracedLevel> fieldsOf(const Source& source, const std::vector<voxelize::Lattice>& lattices,
                                  const std::vector<ondemand::VoxelLevel>& levels, const glm::dvec3& eye) {
    std::vector<TracedLevel> fields;
    double from = 0;
    for (std::size_t n = 0; n < levels.size(); ++n) {
        constexpr double kMarginVoxels = 2;
        const voxelize::Lattice& lattice = lattices[n];
        const bool last = n + 1 == levels.size();
        std::vector<std::uint32_t> near;
        if (!last) {
            const double to = levels[n + 1].from + lattice.background() + kMarginVoxels * lattice.voxel_size;
            near = ondemand::beadsWithin(*source.toolpath, source.selection, eye, to);
            if (near.empty()) continue;
        }
        fields.push_back({std::make_shared<ondemand::PrintField>(source.toolpath, last ? source.selection : near,
                                                                 lattice, voxelize::Placement(), source.path),
                          from});
        if (!last) from = levels[n + 1].from;
    }
    return fields;
}

Json reportOf(const std::vector<TracedLevel>& levels, double per_distance) {
    Json report = Json::array();
    for (std::size_t n = 0; n < levels.size(); ++n) {
        const voxelize::Lattice& lattice = levels[n].field->layout().lattice;
        const double error = voxelize::kLargestErrorVoxels * lattice.voxel_size;
        const double pixel = levels[n].from * per_distance;
        report.push_back({{"voxel_size_mm", lattice.voxel_size},
                          {"from_mm", levels[n].from},
                          {"to_mm", n + 1 < levels.size() ? Json(levels[n + 1].from) : Json(nullptr)},
                          {"beads", levels[n].field->layout().stack.beads.size()},
                          {"largest_error_mm", error},
                          {"largest_error_pixels", pixel > 0 ? Json(error / pixel) : Json(nullptr)}});
    }
    return report;
}

// What people give as a level set and is none is G-code at best.
gcode::Toolpath readEither(const gcode::InputBytes& file, const gcode::ReadOptions& options, bool timed) {
    if (file.bytes().starts_with(kVdbMagic))
        throw InputError(
            fmt::format("{}: holds OpenVDB grids, which can't be read from a stream; give a file", file.name()));
    try {
        motion::PrintTimes times;
        return timed ? motion::readTimedToolpath(file.bytes(), file.name(), options, times)
                     : gcode::readToolpath(file.bytes(), file.name(), options);
    } catch (const InputError& error) {
        if (!file.name().ends_with(".vdb")) throw;
        throw InputError(
            fmt::format("{}: is no OpenVDB file, its first bytes are not those of one; download or convert "
                        "it again. Nor is it G-code ({})",
                        file.name(), error.what()));
    }
}

}  // namespace

void addTracePrintOptions(CLI::App& app, TracePrintOptions& options) {
    app.add_option(
           "--brick-cache", options.brick_cache,
           "brick: no more than this of samples at once, e.g. 200MB; what no ray came to lately makes room, and "
           "the picture stays the same. Of each print, and of each large level set (default: no bound)")
        ->type_name("SIZE")
        ->group("Tracing");
    app.add_option("--brick-picture", options.brick_picture,
                   "brick: also write which of a print's bricks rays came to, from the front and from above")
        ->type_name("FILE.png")
        ->group("Tracing");
    addPrintOptions(app, options.print, true);
    app.add_option("--printed", options.printed,
                   "G-code: what is printed by then: 25%, layer:40, time:90 (minutes; 5400s, 1.5h), or time:50%")
        ->type_name("WHEN")
        ->group("What to convert");
    app.add_option("--progress-series", options.series,
                   "G-code: N numbered pictures of a print that grows by equal volumes, one camera for all")
        ->check(CLI::Range(1, 100000))
        ->excludes("--printed")
        ->type_name("N")
        ->group("What to convert");
    app.add_flag("--by-time", options.series_by_time, "--progress-series: equal times instead of equal volumes")
        ->needs("--progress-series")
        ->group("What to convert");
}

std::vector<std::string> givenPrintOptions(const CLI::App& app) {
    constexpr std::array<std::string_view, 3> kGroups = {kLattice, kWhat, kReading};
    std::vector<std::string> given;
    for (const CLI::Option* option : app.get_options()) {
        const std::string name = option->get_name();
        const bool of_prints = std::find(kGroups.begin(), kGroups.end(), option->get_group()) != kGroups.end() ||
                               name == "--brick-picture";
        if (of_prints && option->count() > 0) given.push_back(name);
    }
    return given;
}

void refusePrintOptions(const std::vector<std::string>& given, const std::string& vdb) {
    if (given.empty()) return;
    const std::string& first = given.front();
    const bool in_time = first == "--printed" || first == "--progress-series";
    const bool of_rays = first == "--brick-picture";
    throw UsageError(fmt::format(
        "{}: needs G-code, and {} is a level set, whose voxels are made; {}give vdbtrace the "
        "print itself",
        fmt::join(given, ", "), vdb,
        of_rays
            ? ""
            : fmt::format("make it anew with gcode2vdb {}, or ", in_time ? "--snapshots" : fmt::format("{}", first))));
}

bool isVdbFile(const std::string& path) {
    if (path == "-") return false;
    std::ifstream file(path, std::ios::binary);
    if (!file) throw InputError(fmt::format("{}: can't be opened; check the name and the permissions", path));
    std::array<char, 4> magic{};
    file.read(magic.data(), magic.size());
    if (file.gcount() == 0) throw InputError(fmt::format("{}: is empty (0 bytes)", path));
    return std::string_view(magic.data(), magic.size()) == kVdbMagic;
}

TracedPrint readTracedPrint(const std::string& path, const TracePrintOptions& options) {
    Stopwatch watch;
    TracedPrint result;
    std::shared_ptr<const gcode::Toolpath> toolpath;
    std::size_t bytes = 0;
    std::string name;
    {
        const gcode::InputBytes file(path);
        bytes = file.bytes().size();
        name = file.name();
        if (options.hash) result.content = sha256Hex(file.bytes());
        gcode::ReadOptions read = options.print.read;
        ProgressBar bar("reading", options.quiet);
        read.progress = bar.callback();
        const bool timed = options.timed || options.series_by_time || voxelize::needsTiming(options.printed);
        toolpath = std::make_shared<const gcode::Toolpath>(readEither(file, read, timed));
    }
    if (!options.quiet) printWarnings("vdbtrace", name, *toolpath);
    result.parse_seconds = watch.lap();
    std::vector<std::uint32_t> selection = voxelize::selectBeads(*toolpath, selectionOf(options.print, *toolpath));
    if (!options.printed.empty()) cut(selection, options.printed, *toolpath);
    const voxelize::Bounds bounds = voxelize::boundsOf(*toolpath, selection);
    const voxelize::Bounds part = voxelize::partBounds(*toolpath, selection);
    const shade::PixelSpread pixels =
        options.print.voxel_auto ? options.pixel_spread(bounds, part) : shade::PixelSpread();
    const double pixel = pixels.smallest;
    const voxelize::Lattice lattice =
        latticeFor(options.print, *toolpath, selection, bounds, voxelize::Interior::keep, pixel);
    if (!lattice.warning.empty() && !options.quiet) fmt::print(stderr, "vdbtrace: {}: {}\n", path, lattice.warning);
    constexpr double kLeastHalfWidth = 2;
    if (lattice.half_width < kLeastHalfWidth)
        throw UsageError(fmt::format("--half-width {:g}: rays need {:g} voxels to each side of the surface, at least",
                                     lattice.half_width, kLeastHalfWidth));
    const Source source{options, toolpath, selection, bounds, path};
    const std::vector<ondemand::VoxelLevel> levels = ondemand::chooseLevels(
        lattice.layer_height, static_cast<int>(std::lround(lattice.layer_height / lattice.voxel_size)), pixel,
        {pixels.per_distance, pixels.farthest});
    const std::vector<voxelize::Lattice> lattices = latticesOf(source, lattice, levels);
    result.eye = pixels.eye;
    result.levels = fieldsOf(source, lattices, levels, result.eye);
    result.report = {{"path", path},
                     {"bytes", bytes},
                     {"format", toolpath->format},
                     {"slicer", toolpath->slicer},
                     {"beads", toolpath->beads.size()},
                     {"selected_beads", selection.size()},
                     {"layers", toolpath->layer_count},
                     {"voxel_size_mm", lattice.voxel_size},
                     {"half_width", lattice.half_width},
                     {"choice", lattice.reason}};
    const std::string chosen = describeSelection(options.print);
    if (!chosen.empty()) result.report["selection"] = chosen;
    if (options.print.voxel_auto)
        result.report["voxel_auto"] = {
            {"smallest_pixel_mm", pixel},
            {"largest_error_mm", voxelize::kLargestErrorVoxels * lattice.voxel_size},
            {"largest_error_pixels",
             pixel > 0 ? Json(voxelize::kLargestErrorVoxels * lattice.voxel_size / pixel) : Json(nullptr)}};
    if (result.levels.size() > 1) result.report["voxel_auto"]["levels"] = reportOf(result.levels, pixels.per_distance);
    if (!options.printed.empty()) result.report["printed"] = options.printed;
    result.line = fmt::format("{}: {} of {} beads; voxel {:g} mm ({})", name, selection.size(), toolpath->beads.size(),
                              lattice.voxel_size, lattice.reason);
    for (std::size_t n = 1; n < result.levels.size(); ++n)
        result.line += fmt::format("; {:g} mm from {:.3g} mm away", result.levels[n].field->layout().lattice.voxel_size,
                                   result.levels[n].from);
    result.selection = std::move(selection);
    result.moments = momentsOf(options.series, options.series_by_time, *toolpath);
    result.toolpath = std::move(toolpath);
    result.part = part;
    return result;
}

}  // namespace stratum::tools
