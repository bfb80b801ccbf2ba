#include "python/conversion.h"

#include "python/options/print_options.h"

#include "export/vdb_stream.h"
#include "gcode/slicer/bead_colors.h"
#include "voxelize/beads/part_bounds.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/interior_distance.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
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

}  // namespace

ConversionOptions conversionOptionsOf(Keywords& keywords) {
    ConversionOptions options;
    options.print = printOptionsOf(keywords);
    assign(options.interior, keywords.choice("interior", kInteriors));
    assign(options.interior_distance, keywords.flag("interior_distance"));
    if (keywords.find("grids"))
        options.attributes = voxelize::parseGrids(fmt::format("{}", fmt::join(keywords.texts("grids"), ",")));
    assign(options.unit, keywords.choice("unit", kUnits));
    assign(options.up, keywords.choice("up", kUps));
    assign(options.origin, keywords.choice("origin", kOrigins));
    return options;
}

Conversion::Conversion(const ToolpathObject& print, ConversionOptions options)
    : print_(print),
      toolpath_(*print.toolpath),
      options_(std::move(options)),
      selection_(voxelize::selectBeads(toolpath_, voxelize::selectionOf(options_.print, toolpath_))),
      bounds_(voxelize::boundsOf(toolpath_, selection_)),
      lattice_(voxelize::latticeFor(options_.print, toolpath_, selection_, bounds_, options_.interior)),
      placement_(voxelize::placementOf(options_.unit, options_.up, options_.origin, bounds_)) {
    const std::vector<std::optional<gcode::Rgb>> colors = gcode::distinctColors(toolpath_, selection_);
    if (options_.attributes)
        attributes_ = *options_.attributes;
    else if (colors.size() > 1)
        attributes_.push_back(voxelize::Attribute::color);
    if (colors.size() == 1 && colors.front()) {
        const auto& [red, green, blue] = *colors.front();
        filament_color_ = fmt::format("#{:02X}{:02X}{:02X}", red, green, blue);
    }
}

bool Conversion::streams() const {
    return options_.interior == voxelize::Interior::keep && attributes_.empty() && !options_.interior_distance;
}

voxelize::VoxelizeOptions Conversion::voxelizeOptions(const Report& report) const {
    voxelize::VoxelizeOptions options;
    options.placement = placement_;
    options.interior = options_.interior;
    options.progress = report;
    return options;
}

exporter::Provenance Conversion::provenance() const {
    exporter::Provenance provenance;
    provenance.source_file = print_.source;
    provenance.source_sha256 = print_.source.empty() ? "" : print_.source_sha256;
    provenance.slicer = toolpath_.slicer;
    provenance.unit = options_.unit;
    provenance.up = options_.up;
    provenance.selection = voxelize::describeSelection(options_.print);
    provenance.filament_color = filament_color_;
    provenance.part = voxelize::placed(voxelize::partBounds(toolpath_, selection_), placement_);
    provenance.deposit = toolpath_.deposit;
    provenance.culled = options_.interior == voxelize::Interior::cull;
    provenance.swept = options_.interior_distance;
    return provenance;
}

openvdb::GridPtrVec Conversion::makeGrids(const Report& report) {
    voxelize::Voxelizer voxelizer(toolpath_, selection_, lattice_, voxelizeOptions(report));
    const openvdb::FloatGrid::Ptr grid = voxelizer.printAll();
    openvdb::GridPtrVec grids = voxelizer.attributes(attributes_);
    if (options_.interior_distance) voxelize::sweepInterior(*grid);
    exporter::describe(*grid, lattice_, provenance());
    grids.insert(grids.begin(), grid);
    return grids;
}

void Conversion::write(const std::filesystem::path& path, const exporter::FileOptions& file, const Report& report) {
    if (!streams()) {
        exporter::writeVdb(makeGrids(report), path, file);
        return;
    }
    voxelize::VoxelizeOptions options = voxelizeOptions(report);
    options.in_memory = false;
    voxelize::Voxelizer voxelizer(toolpath_, selection_, lattice_, std::move(options));
    const openvdb::FloatGrid::Ptr empty = voxelizer.emptyGrid();
    exporter::describe(*empty, lattice_, provenance());
    const voxelize::LeafBounds bounds = voxelizer.leafBounds();
    exporter::VdbStream stream(empty, path, file, bounds);
    (void)voxelizer.stream(std::numeric_limits<std::uint32_t>::max(), bounds, stream, false);
    (void)stream.finish();
}

}  // namespace stratum::python
