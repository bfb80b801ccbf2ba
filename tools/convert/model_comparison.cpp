#include "convert/model_comparison.h"

#include "base/text.h"
#include "choices.h"
#include "progress.h"

#include "base/error.h"
#include "compare/comparison_report.h"
#include "compare/model_file.h"
#include "gcode/toolpath/purpose.h"
#include "voxelize/grid/voxelizer.h"

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <vector>

namespace stratum::tools {
namespace {

std::string lineOf(const char* what, const compare::Deviations& found) {
    if (found.samples == 0) return fmt::format("    {:8} none", what);
    return fmt::format("    {:8} mean {:+.3f}, RMS {:.3f}, 95 % within {:.3f}, from {:+.3f} to {:+.3f} mm", what,
                       found.mean, found.rms, found.within_95, found.least.mm, found.most.mm);
}

void tell(const ConvertCommand& o, const compare::Comparison& found) {
    const std::string fitted =
        found.fit ? fmt::format("; best fit, {:.3f} mm (RMS) from the print", found.fit->residual) : "";
    say(o.common, fmt::format("  {}: {}{}", o.compare.model, compare::describe(found.model_to_print), fitted));
    for (const auto& [title, way] : {std::pair{"the print from the model", &found.print_to_model},
                                     std::pair{"the model from the print", &found.model_to_surface}}) {
        say(o.common, fmt::format("  {}; + is too much, - is missing:", title));
        for (const auto& [what, part] : {std::pair{"all", &way->all}, std::pair{"walls", &way->walls},
                                         std::pair{"tops", &way->tops}, std::pair{"bottoms", &way->bottoms}})
            say(o.common, lineOf(what, *part));
    }
}

}  // namespace

void addCompareOptions(CLI::App& app, CompareCommand& options) {
    const char* model = "Beside the model";
    app.add_option("--compare", options.model,
                   "Distances of the printed surface from this model, and back: .stl, .3mf or .obj. With --grids "
                   "deviation also as a grid")
        ->type_name("FILE")
        ->group(model);
    app.add_option("--compare-at", options.placement,
                   "Where the model lies: fit: where it fits the print best (default); bed: as in its file")
        ->check(oneOf({"fit", "bed"}))
        ->needs("--compare")
        ->type_name("WHERE")
        ->group(model);
}

bool takeDeviation(ConvertCommand& o) {
    std::string left;
    bool found = false;
    for (const std::string_view name : splitList(o.grids)) {
        if (name == "deviation")
            found = true;
        else
            left += fmt::format("{}{}", left.empty() ? "" : ",", name);
    }
    if (!found) return false;
    if (o.compare.model.empty())
        throw UsageError("--grids deviation: is from a model; name it, e.g. --compare part.stl");
    // Without a list a print of several colors would have a grid of them.
    o.grids = left.empty() ? "surface" : left;
    return true;
}

ModelComparison compareWithModel(const ConvertCommand& o, const gcode::Toolpath& toolpath,
                                 std::span<const std::uint32_t> selection, const voxelize::Lattice& lattice) {
    ModelComparison comparison;
    comparison.model =
        std::make_unique<const compare::ClosedModel>(compare::readModel(o.compare.model), o.compare.model);
    const ProgressNote note("comparing", o.common.quiet);
    voxelize::VoxelizeOptions outside;
    outside.interior = voxelize::Interior::cull;
    outside.placement = voxelize::placementOf(toolpath);
    const std::vector<std::uint32_t> part =
        gcode::beadsUpTo(gcode::Purpose::part, gcode::purposesOf(toolpath), selection);
    const openvdb::FloatGrid::Ptr grid = voxelize::voxelize(toolpath, part, lattice, outside);
    compare::CompareOptions options;
    options.line_width = gcode::meanWidth(toolpath, part);
    if (o.compare.placement == "bed") options.placement = compare::ModelPlacement::bed;
    comparison.found = compare::compareToModel(*grid, *comparison.model, options);
    tell(o, comparison.found);
    if (!o.common.quiet)
        for (const std::string& doubt : comparison.found.doubts)
            tellError(fmt::format("gcode2vdb: {}: {}\n", o.compare.model, doubt));
    return comparison;
}

}  // namespace stratum::tools
