#include "python/conversion.h"

#include "assemble/print/read_print_options.h"
#include "base/error.h"
#include "export/vdb_stream.h"
#include "voxelize/grid/interior_distance.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>

namespace stratum::python {

namespace {

using Names = std::array<std::pair<std::string_view, std::string_view>, 3>;
constexpr Names kUnits = {{{"mm", "mm"}, {"cm", "cm"}, {"m", "m"}}};
constexpr Names kOrigins = {{{"bed", "bed"}, {"center", "center"}, {"min", "min"}}};
constexpr std::array<std::pair<std::string_view, std::string_view>, 2> kUps = {{{"z", "z"}, {"y", "y"}}};
constexpr std::array<std::pair<std::string_view, voxelize::Interior>, 2> kInteriors = {
    {{"keep", voxelize::Interior::keep}, {"cull", voxelize::Interior::cull}}};

exporter::Provenance provenanceOf(const ToolpathObject& print, const exporter::LevelSetPlan& plan) {
    return plan.provenance(print.source, print.source.empty() ? "" : print.source_sha256, plan.selection());
}

}  // namespace

void requireTimes(const gcode::Toolpath& toolpath, std::span<const voxelize::Attribute> attributes) {
    if (!toolpath.timing.empty()) return;
    for (const voxelize::Attribute attribute : attributes)
        if (voxelize::usesTiming(attribute))
            throw UsageError(fmt::format("{}: the toolpath has no times; read it with timed=True",
                                         voxelize::attributeName(attribute)));
}

exporter::LevelSetChoices levelSetChoicesOf(Keywords& keywords) {
    exporter::LevelSetChoices choices;
    assemble::readConversion(keywords, choices.print);
    assign(choices.interior, keywords.choice("interior", kInteriors));
    assign(choices.interior_distance, keywords.flag("interior_distance"));
    if (keywords.find("grids"))
        choices.attributes = voxelize::parseGrids(fmt::format("{}", fmt::join(keywords.texts("grids"), ",")));
    assign(choices.unit, keywords.choice("unit", kUnits));
    assign(choices.up, keywords.choice("up", kUps));
    assign(choices.origin, keywords.choice("origin", kOrigins));
    return choices;
}

openvdb::GridPtrVec makeGrids(const ToolpathObject& print, const exporter::LevelSetPlan& plan, const Report& report) {
    requireTimes(*print.toolpath, plan.attributes());
    voxelize::VoxelizeOptions options = plan.voxelizeOptions();
    options.progress = report;
    voxelize::Voxelizer voxelizer(*print.toolpath, plan.selection(), plan.lattice(), std::move(options));
    const openvdb::FloatGrid::Ptr grid = voxelizer.printAll();
    openvdb::GridPtrVec grids = voxelizer.attributes(plan.attributes());
    if (plan.choices().interior_distance) voxelize::sweepInterior(*grid);
    exporter::describe(*grid, plan.lattice(), provenanceOf(print, plan));
    grids.insert(grids.begin(), grid);
    return grids;
}

void writePrint(const ToolpathObject& print, const exporter::LevelSetPlan& plan, const std::filesystem::path& path,
                const exporter::FileOptions& file, const Report& report) {
    if (!plan.streams()) {
        exporter::writeVdb(makeGrids(print, plan, report), path, file);
        return;
    }
    voxelize::VoxelizeOptions options = plan.voxelizeOptions();
    options.progress = report;
    options.bytes_per_leaf = 0;
    voxelize::Voxelizer voxelizer(*print.toolpath, plan.selection(), plan.lattice(), std::move(options));
    const openvdb::FloatGrid::Ptr empty = voxelizer.emptyGrid();
    exporter::describe(*empty, plan.lattice(), provenanceOf(print, plan));
    const voxelize::LeafBounds bounds = voxelizer.leafBounds();
    exporter::VdbStream stream(empty, path, file, bounds);
    (void)voxelizer.stream(std::numeric_limits<std::uint32_t>::max(), bounds, stream, false);
    (void)stream.finish();
}

}  // namespace stratum::python
