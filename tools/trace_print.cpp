#include "trace_print.h"

#include "command_line.h"

#include "gcode/input_bytes.h"
#include "gcode/reader.h"
#include "io/error.h"
#include "voxelize/selection.h"
#include "voxelize/voxel_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>
#include <utility>
#include <vector>

namespace stratum::tools {
namespace {

using Json = nlohmann::ordered_json;

// Those of the selection that are printed by then.
void cut(std::vector<std::uint32_t>& selection, const std::string& printed, const gcode::Toolpath& toolpath) {
    const std::vector<voxelize::Snapshot> cuts = voxelize::parseSnapshots(printed, toolpath, "--printed");
    if (cuts.size() != 1)
        throw UsageError(fmt::format("--printed {}: expected one moment, e.g. 50%, layer:40 or time:90", printed));
    const auto last = std::lower_bound(selection.begin(), selection.end(), cuts.front().bead_count);
    selection.erase(last, selection.end());
    if (selection.empty())
        throw UsageError(fmt::format("--printed {}: nothing of what is selected is printed by then", printed));
}

// Equal steps of the extruded volume; the last one is all. Prints of few beads have fewer.
std::vector<std::uint32_t> momentsOf(int series, const gcode::Toolpath& toolpath) {
    std::vector<std::uint32_t> moments;
    std::string steps;
    for (int n = 1; n < series; ++n) steps += fmt::format("{}{:.9g}%", n > 1 ? "," : "", 100.0 * n / series);
    if (!steps.empty())
        for (const voxelize::Snapshot& step : voxelize::parseSnapshots(steps, toolpath))
            moments.push_back(static_cast<std::uint32_t>(step.bead_count));
    moments.push_back(static_cast<std::uint32_t>(toolpath.beads.size()));
    return moments;
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
                   "G-code: what is printed by then: 25%, layer:40, or time:90 (minutes of extruding)")
        ->type_name("WHEN")
        ->group("What to convert");
    app.add_option("--progress-series", options.series,
                   "G-code: N numbered pictures of a print that grows by equal volumes, one camera for all")
        ->check(CLI::Range(1, 100000))
        ->excludes("--printed")
        ->type_name("N")
        ->group("What to convert");
}

bool isVdbFile(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw InputError(fmt::format("{}: can't be opened; check the name and the permissions", path));
    std::array<char, 4> magic{};
    file.read(magic.data(), magic.size());
    if (file.gcount() == 0) throw InputError(fmt::format("{}: is empty (0 bytes)", path));
    return std::string_view(magic.data(), magic.size()) == std::string_view(" BDV", 4);
}

TracedPrint readTracedPrint(const std::string& path, const TracePrintOptions& options) {
    Stopwatch watch;
    TracedPrint result;
    std::shared_ptr<const gcode::Toolpath> toolpath;
    std::size_t bytes = 0;
    {
        const gcode::InputBytes file(path);
        bytes = file.bytes().size();
        gcode::ReadOptions read = options.print.read;
        ProgressBar bar("reading", options.quiet);
        read.progress = bar.callback();
        toolpath = std::make_shared<const gcode::Toolpath>(gcode::readToolpath(file.bytes(), file.name(), read));
        if (!options.quiet)
            for (const gcode::Warning& warning : toolpath->warnings)
                fmt::print(stderr, "vdbtrace: {}:{}: {}{}\n", file.name(), warning.first_line, warning.text,
                           warning.count > 1 ? fmt::format(" ({} times)", warning.count) : "");
    }
    result.parse_seconds = watch.lap();
    std::vector<std::uint32_t> selection = voxelize::selectBeads(*toolpath, selectionOf(options.print, *toolpath));
    if (!options.printed.empty()) cut(selection, options.printed, *toolpath);
    const voxelize::Bounds bounds = voxelize::boundsOf(*toolpath, selection);
    const double pixel = options.print.voxel_auto ? options.smallest_pixel(bounds) : 0.0;
    const voxelize::Lattice lattice =
        latticeFor(options.print, *toolpath, selection, bounds, voxelize::Interior::keep, pixel);
    constexpr double kLeastHalfWidth = 2;
    if (lattice.half_width < kLeastHalfWidth)
        throw UsageError(fmt::format("--half-width {:g}: rays need {:g} voxels to each side of the surface, at least",
                                     lattice.half_width, kLeastHalfWidth));
    result.field = std::make_shared<ondemand::PrintField>(toolpath, selection, lattice, voxelize::Placement(), path);
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
    if (!options.printed.empty()) result.report["printed"] = options.printed;
    result.line = fmt::format("{}: {} of {} beads; voxel {:g} mm ({})", path, selection.size(), toolpath->beads.size(),
                              lattice.voxel_size, lattice.reason);
    result.selection = std::move(selection);
    result.moments = momentsOf(options.series, *toolpath);
    return result;
}

}  // namespace stratum::tools
