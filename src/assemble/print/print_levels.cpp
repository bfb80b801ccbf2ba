#include "assemble/print/print_levels.h"

#include "assemble/print/kept_prints.h"
#include "base/checksum.h"
#include "base/error.h"
#include "base/stopwatch.h"
#include "deposit/read_print.h"
#include "gcode/container/container.h"
#include "gcode/toolpath/warning_log.h"
#include "march/file/vdb_walker.h"
#include "ondemand/detail_levels.h"
#include "voxelize/beads/part_outline.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxel_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace stratum::assemble {
namespace {

using Json = nlohmann::ordered_json;

// Removes the beads that are printed later.
void cut(std::vector<std::uint32_t>& selection, const std::string& printed, const gcode::Toolpath& toolpath) {
    const std::vector<voxelize::Snapshot> cuts = voxelize::parseSnapshots(printed, toolpath, "--printed");
    if (cuts.size() > 1)
        throw UsageError(
            fmt::format("--printed {}: expected one moment, e.g. 50%, layer:40, time:90 or time:50%", printed));
    const std::size_t beads = cuts.empty() ? 0 : cuts.front().bead_count;
    selection.erase(std::lower_bound(selection.begin(), selection.end(), beads), selection.end());
    if (selection.empty())
        throw UsageError(fmt::format("--printed {}: nothing of what is selected is printed by then", printed));
}

// Equal steps of the extruded volume, or of time; the last one is all. Prints of few beads have fewer.
std::vector<std::uint32_t> momentsOf(int series, bool by_time, const gcode::Toolpath& toolpath,
                                     const std::vector<std::uint32_t>& selection) {
    std::vector<std::uint32_t> moments;
    if (selection.size() < toolpath.beads.size()) {
        // Of what is selected, as films have it: shares of the whole file might show nothing until the end.
        const auto by = by_time ? voxelize::GrowthBy::time : voxelize::GrowthBy::volume;
        moments =
            voxelize::growthMoments(toolpath, selection, {by, voxelize::equalShares(static_cast<std::size_t>(series))});
        moments.erase(std::unique(moments.begin(), moments.end()), moments.end());
        return moments;
    }
    std::string steps;
    for (int n = 1; n < series; ++n)
        steps += fmt::format("{}{}{:.9g}%", n > 1 ? "," : "", by_time ? "time:" : "", 100.0 * n / series);
    if (!steps.empty())
        for (const voxelize::Snapshot& step : voxelize::parseSnapshots(steps, toolpath))
            moments.push_back(static_cast<std::uint32_t>(step.bead_count));
    moments.push_back(static_cast<std::uint32_t>(toolpath.beads.size()));
    return moments;
}

// Ends of the last selected beads before each moment, in the world; of the first one, if there is none.
std::vector<glm::dvec3> tipsOf(const std::vector<std::uint32_t>& moments, const std::vector<std::uint32_t>& selection,
                               const gcode::Toolpath& toolpath) {
    std::vector<glm::dvec3> tips;
    tips.reserve(moments.size());
    for (const std::uint32_t moment : moments) {
        const auto after = std::lower_bound(selection.begin(), selection.end(), moment);
        const gcode::Bead& bead = toolpath.beads[after == selection.begin() ? selection.front() : *(after - 1)];
        const auto [x, y, z] = voxelize::worldOf({bead.x1, bead.y1, bead.z1}, voxelize::placementOf(toolpath));
        tips.emplace_back(x, y, z);
    }
    return tips;
}

/// What all fields of one print are made from.
struct Source {
    const PrintRequest& request;
    const std::shared_ptr<const gcode::Toolpath>& toolpath;
    const std::vector<std::uint32_t>& selection;
    const voxelize::Bounds& bounds;
    const std::string& path;
};

// Lattices of the levels: far from an eye that is close to the print, pixels span more, and voxels may be larger. The
// first level has the given lattice.
std::vector<voxelize::Lattice> latticesOf(const Source& source, const voxelize::Lattice& finest,
                                          const std::vector<ondemand::VoxelLevel>& levels) {
    std::vector<voxelize::Lattice> lattices{finest};
    voxelize::LatticeRequest request = source.request.print.lattice;
    for (std::size_t n = 1; n < levels.size(); ++n) {
        request.voxels_per_layer = levels[n].voxels_per_layer;
        lattices.push_back(voxelize::chooseLattice(*source.toolpath, source.selection, source.bounds, request));
    }
    return lattices;
}

// A field a level, of the beads that reach its shell, including the narrow band and the neighbours of samples. Levels
// without beads are left out.
std::vector<PrintLevel> fieldsOf(const Source& source, const std::vector<voxelize::Lattice>& lattices,
                                 const std::vector<ondemand::VoxelLevel>& levels, const glm::dvec3& eye) {
    std::vector<PrintLevel> fields;
    const voxelize::Placement placement = voxelize::placementOf(*source.toolpath);
    const auto [x, y, z] = voxelize::printOf({eye.x, eye.y, eye.z}, placement);
    double from = 0;
    for (std::size_t n = 0; n < levels.size(); ++n) {
        constexpr double kMarginVoxels = 2;
        const voxelize::Lattice& lattice = lattices[n];
        const bool last = n + 1 == levels.size();
        std::vector<std::uint32_t> near;
        if (!last) {
            const double to = levels[n + 1].from + lattice.background() + kMarginVoxels * lattice.voxel_size;
            near = ondemand::beadsWithin(*source.toolpath, source.selection, {x, y, z}, to);
            if (near.empty()) continue;
        }
        fields.push_back({std::make_shared<ondemand::PrintField>(source.toolpath, last ? source.selection : near,
                                                                 lattice, placement, source.path),
                          from});
        if (!last) from = levels[n + 1].from;
    }
    return fields;
}

Json reportOf(const std::vector<PrintLevel>& levels, double per_distance) {
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

// A file that is no .vdb is read as G-code; one named .vdb gets a message about both.
deposit::PrintRead readEither(const gcode::InputBytes& file, const gcode::ReadOptions& options, bool timed) {
    if (file.bytes().starts_with(march::kVdbMagic))
        throw InputError(
            fmt::format("{}: holds OpenVDB grids, which can't be read from a stream; give a file", file.name()));
    try {
        return deposit::readPrint(file.bytes(), file.name(), options, timed);
    } catch (const InputError& error) {
        if (!file.name().ends_with(".vdb")) throw;
        throw InputError(
            fmt::format("{}: is no OpenVDB file, its first bytes are not those of one; download or convert "
                        "it again. Nor is it G-code ({})",
                        file.name(), error.what()));
    }
}

}  // namespace

ReadProgram readProgram(const std::string& path, const PrintRequest& request, const ReadEvents& events,
                        Warnings& warnings, bool hash) {
    const bool grows_by_time = request.growth && request.growth->by != voxelize::GrowthBy::volume;
    const bool timed =
        request.timed || request.series_by_time || grows_by_time || voxelize::needsTiming(request.printed);
    if (request.toolpath && timed && request.toolpath->timing.empty())
        throw UsageError(
            fmt::format("{}: the toolpath has no times, which this picture needs; read it with them "
                        "(timed=True)",
                        path));
    if (request.toolpath) return {request.toolpath, 0, path, ""};
    if (request.kept != nullptr)
        if (const ReadProgram* known = request.kept->program(path, timed, hash)) return *known;
    ReadProgram program;
    {
        using Streams = gcode::InputBytes::Streams;
        const gcode::InputBytes file(path, request.kept != nullptr ? Streams::refuse : Streams::read);
        program.bytes = file.bytes().size();
        program.name = file.name();
        if (hash) program.content = sha256Hex(file.bytes());
        gcode::ReadOptions read = request.print.read;
        const Step step(events, "reading", true);
        if (events.fraction) read.progress = events.fraction;
        program.toolpath = std::make_shared<const gcode::Toolpath>(readEither(file, read, timed).toolpath);
    }
    for (const gcode::Warning& warning : program.toolpath->warnings)
        warnings.add(Warning::Kind::program, gcode::describe(warning, program.name));
    if (request.kept != nullptr) request.kept->keep(path, program);
    return program;
}

namespace {

/// One print, step by step: each method needs what those before it found.
class PrintReader {
public:
    PrintReader(const std::string& path, const PrintRequest& request, const ReadEvents& events, Warnings& warnings)
        : path_(path), request_(request), events_(events), warnings_(warnings) {}

    PrintLevels read(bool hash) {
        if (request_.print.voxel_auto && !request_.pixel_spread)
            throw UsageError("--voxel-size auto: is of a print that stands alone before one camera; give a number");
        Stopwatch watch;
        use(readProgram(path_, request_, events_, warnings_, hash));
        result_.parse_seconds = watch.lap();
        select();
        chooseLattice();
        chooseLevels();
        describe();
        result_.moments = request_.growth ? voxelize::growthMoments(*toolpath_, selection_, *request_.growth)
                                          : momentsOf(request_.series, request_.series_by_time, *toolpath_, selection_);
        result_.tips = tipsOf(result_.moments, selection_, *toolpath_);
        result_.selection = std::move(selection_);
        result_.toolpath = std::move(toolpath_);
        return std::move(result_);
    }

private:
    void use(const ReadProgram& program) {
        toolpath_ = program.toolpath;
        bytes_ = program.bytes;
        name_ = program.name;
        result_.content = program.content;
    }

    void select() {
        selection_ = voxelize::selectBeads(*toolpath_, voxelize::selectionOf(request_.print, *toolpath_));
        if (!request_.printed.empty()) cut(selection_, request_.printed, *toolpath_);
        bounds_ = voxelize::boundsOf(*toolpath_, selection_);
        const std::vector<gcode::Purpose> purposes = gcode::purposesOf(*toolpath_);
        const voxelize::Placement placement = voxelize::placementOf(*toolpath_);
        const voxelize::Bounds part = voxelize::partBounds(*toolpath_, purposes, selection_);
        result_.part =
            placement.tilt == 0 ? part : voxelize::partBounds(*toolpath_, purposes, selection_, placement.tilt);
        if (!request_.outline) return;
        for (const auto& [x, y, z] :
             voxelize::placed(voxelize::partOutline(*toolpath_, purposes, selection_, part), placement))
            result_.outline.emplace_back(x, y, z);
    }

    void chooseLattice() {
        const bool by_itself = !voxelize::choosesVoxels(request_.print);
        std::optional<shade::PixelSpread> spread;
        // Prints that are kept for other pictures do not follow one camera.
        if (request_.pixel_spread && (request_.print.voxel_auto || (by_itself && request_.kept == nullptr)))
            spread = request_.pixel_spread(toolpath_->belt_angle == 0
                                               ? bounds_
                                               : voxelize::boundsOf(*toolpath_, selection_, toolpath_->belt_angle),
                                           result_.part, result_.outline);
        if (request_.print.voxel_auto) pixels_ = *spread;
        lattice_ = voxelize::latticeFor(request_.print, *toolpath_, selection_, bounds_, voxelize::Interior::keep,
                                        spread ? spread->smallest : 0);
        if (!lattice_.warning.empty())
            warnings_.add(Warning::Kind::voxel_size, fmt::format("{}: {}", path_, lattice_.warning));
        constexpr double kLeastHalfWidth = 2;
        if (lattice_.half_width < kLeastHalfWidth)
            throw UsageError(
                fmt::format("--half-width {:g}: rays need {:g} voxels to each side of the surface, at least",
                            lattice_.half_width, kLeastHalfWidth));
    }

    void chooseLevels() {
        const Source source{request_, toolpath_, selection_, bounds_, path_};
        const std::vector<ondemand::VoxelLevel> levels = ondemand::chooseLevels(
            lattice_.layer_height, static_cast<int>(std::lround(lattice_.layer_height / lattice_.voxel_size)),
            pixels_.smallest, {pixels_.per_distance, pixels_.farthest});
        result_.eye = pixels_.eye;
        result_.levels = fieldsOf(source, latticesOf(source, lattice_, levels), levels, result_.eye);
    }

    void describe() {
        Json& report = result_.report;
        report = {{"path", path_},
                  {"bytes", bytes_},
                  {"format", toolpath_->format},
                  {"slicer", toolpath_->slicer},
                  {"beads", toolpath_->beads.size()},
                  {"selected_beads", selection_.size()},
                  {"layers", toolpath_->layer_count},
                  {"voxel_size_mm", lattice_.voxel_size},
                  {"half_width", lattice_.half_width},
                  {"choice", lattice_.reason},
                  {"deposit", {{"model", gcode::describe(toolpath_->deposit)}}}};
        const std::string chosen = voxelize::describeSelection(request_.print);
        if (!chosen.empty()) report["selection"] = chosen;
        const double error = voxelize::kLargestErrorVoxels * lattice_.voxel_size;
        if (request_.print.voxel_auto)
            report["voxel_auto"] = {
                {"smallest_pixel_mm", pixels_.smallest},
                {"largest_error_mm", error},
                {"largest_error_pixels", pixels_.smallest > 0 ? Json(error / pixels_.smallest) : Json(nullptr)}};
        if (result_.levels.size() > 1) report["voxel_auto"]["levels"] = reportOf(result_.levels, pixels_.per_distance);
        if (!request_.printed.empty()) report["printed"] = request_.printed;
        result_.line = fmt::format("{}: {} of {} beads; voxel {:g} mm ({})", name_, selection_.size(),
                                   toolpath_->beads.size(), lattice_.voxel_size, lattice_.reason);
        for (std::size_t n = 1; n < result_.levels.size(); ++n)
            result_.line += fmt::format("; {:g} mm from {:.3g} mm away",
                                        result_.levels[n].field->layout().lattice.voxel_size, result_.levels[n].from);
    }

    const std::string& path_;
    const PrintRequest& request_;
    const ReadEvents& events_;
    Warnings& warnings_;
    std::shared_ptr<const gcode::Toolpath> toolpath_;
    std::size_t bytes_ = 0;
    std::string name_;  // of the file, in messages
    std::vector<std::uint32_t> selection_;
    voxelize::Bounds bounds_;
    shade::PixelSpread pixels_;  // zeros unless the voxel size follows from the picture
    voxelize::Lattice lattice_;
    PrintLevels result_;
};

}  // namespace

trace::Box boxOf(const voxelize::Bounds& bounds) {
    const auto& [min, max] = bounds;
    return {{min[0], min[1], min[2]}, {max[0], max[1], max[2]}};
}

PrintLevels readPrintLevels(const std::string& path, const PrintRequest& request, bool hash, const ReadEvents& events,
                            Warnings& warnings) {
    return PrintReader(path, request, events, warnings).read(hash);
}

}  // namespace stratum::assemble
