#include "python/bindings.h"

#include "base/json_text.h"
#include "python/conversion.h"
#include "python/errors.h"
#include "python/long_call.h"
#include "python/options/keywords.h"

#include "assemble/print/read_print_options.h"
#include "python/options/path.h"
#include "python/options/signature.h"
#include "python/toolpath_object.h"

#include "compare/comparison_report.h"
#include "compare/model_file.h"
#include "gcode/toolpath/purpose.h"
#include "report/print_report.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxelizer.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>

#include <array>
#include <string_view>
#include <utility>

namespace stratum::python {

namespace py = pybind11;
using namespace py::literals;

namespace {

constexpr const char* kReport =
    R"(A dict: numbers of a print, as gcode2vdb --report writes them: each with its title, value, unit and definition; columns by layer
and by height; and what could not be told, with the reason. density in g/cm3 and price of a kg replace the file's. Options
of voxelize(). A toolpath that was read with timed=True has its time in it.

Raises UsageError for options that don't fit the print or the memory.)";

constexpr const char* kCompare =
    R"(A dict: how far a print is from its model (.stl, .3mf, .obj), and the model from the print, as gcode2vdb --compare tells: mean, RMS,
what 95 % stay within, extremes and their places, in mm, by the side that the model's surface looks to. at: "fit"
(default) places the model where it fits best, "bed" as its file has it. Options: voxel_size (mm), voxels_per_layer, tolerance (mm),
memory_budget, half_width (voxels); layers, features, objects, tools.

Raises InputError for a model that is open or inside out.)";

constexpr std::array<std::pair<std::string_view, compare::ModelPlacement>, 2> kPlacements = {
    {{"fit", compare::ModelPlacement::fit}, {"bed", compare::ModelPlacement::bed}}};

py::object dictOf(const nlohmann::ordered_json& json) {
    return py::module_::import("json").attr("loads")(inPython(jsonText(json)));
}

py::object reportPrint(const ToolpathObject& print, const py::object& progress, const py::kwargs& given) {
    Keywords keywords("report", given);
    report::ReportOptions options;
    options.density = keywords.numberIn("density", 0.01, 25);
    options.price = keywords.numberIn("price", 0, 1e9);
    exporter::LevelSetChoices choices = levelSetChoicesOf(keywords);
    keywords.finish();
    if (keywords.find("unit")) throw UsageError("report(): unit: a report is in mm");
    choices.attributes.emplace();
    options.source = print.source;
    options.selection = voxelize::describeSelection(choices.print);
    options.culled = choices.interior == voxelize::Interior::cull;
    return dictOf(callLong(progress, [&](const Report& report) {
        const exporter::LevelSetPlan plan(*print.toolpath, std::move(choices));
        const openvdb::GridPtrVec grids = makeGrids(print, plan, report);
        return report::reportOf(static_cast<const openvdb::FloatGrid&>(*grids.front()), *print.toolpath,
                                plan.selection(), plan.lattice(), print.times, options);
    }));
}

py::object comparePrint(const ToolpathObject& print, const py::object& model, const py::object& progress,
                        const py::kwargs& given) {
    Keywords keywords("compare", given);
    compare::CompareOptions options;
    assign(options.placement, keywords.choice("at", kPlacements));
    exporter::LevelSetChoices choices;
    assemble::readConversion(keywords, choices.print);
    choices.interior = voxelize::Interior::cull;
    choices.attributes.emplace();
    keywords.finish();
    const auto path = pathOf(model);
    return dictOf(callLong(progress, [&](const Report& report) {
        const compare::ClosedModel closed(compare::readModel(path), path);
        const exporter::LevelSetPlan plan(*print.toolpath, std::move(choices));
        voxelize::VoxelizeOptions outside;
        outside.interior = voxelize::Interior::cull;
        outside.placement = voxelize::placementOf(*print.toolpath);
        outside.progress = report;
        const std::vector<std::uint32_t> part =
            gcode::beadsUpTo(gcode::Purpose::part, gcode::purposesOf(*print.toolpath), plan.selection());
        const auto grid = voxelize::voxelize(*print.toolpath, part, plan.lattice(), outside);
        compare::CompareOptions measured = options;
        measured.line_width = gcode::meanWidth(*print.toolpath, part);
        return compare::describe(compare::compareToModel(*grid, closed, measured));
    }));
}

}  // namespace

void bindMeasures(py::module_& module) {
    module.def("report", &reportPrint,
               documented(fmt::format("report(toolpath, *, progress=None, density=None, price=None, {})",
                                      parametersOf([](Keywords& given) { (void)levelSetChoicesOf(given); })),
                          kReport)
                   .c_str(),
               "toolpath"_a, py::kw_only(), "progress"_a = py::none());
    module.def(
        "compare", &comparePrint,
        documented(fmt::format("compare(toolpath, model, *, progress=None, at=None, {})", conversionParameters()),
                   kCompare)
            .c_str(),
        "toolpath"_a, "model"_a, py::kw_only(), "progress"_a = py::none());
}

}  // namespace stratum::python
