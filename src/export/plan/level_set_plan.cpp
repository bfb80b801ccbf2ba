#include "export/plan/level_set_plan.h"

#include "export/mesh/surface_mesh.h"
#include "export/nano_file.h"
#include "gcode/toolpath/color.h"
#include "voxelize/beads/part_outline.h"
#include "voxelize/grid/interior_distance.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace stratum::exporter {

LevelSetPlan::LevelSetPlan(const gcode::Toolpath& toolpath, LevelSetChoices choices)
    : toolpath_(toolpath),
      choices_(std::move(choices)),
      selection_(selected()),
      bounds_(voxelize::boundsOf(toolpath, selection_)),
      colors_(gcode::distinctColors(toolpath, selection_)),
      attributes_(chosenAttributes()),
      lattice_(
          voxelize::latticeFor(choices_.print, toolpath, selection_, bounds_, choices_.interior, 0, bytesPerLeaf())),
      lying_(toolpath.belt_angle == 0 ? bounds_ : voxelize::boundsOf(toolpath, selection_, toolpath.belt_angle)),
      placement_(voxelize::placementOf(choices_.unit, choices_.up, choices_.origin, lying_, toolpath.belt_angle)) {}

std::vector<voxelize::Attribute> LevelSetPlan::chosenAttributes() const {
    if (choices_.attributes) return *choices_.attributes;
    if (addsColor()) return {voxelize::Attribute::color};
    return {};
}

double LevelSetPlan::bytesPerLeaf() const {
    double bytes = voxelize::bytesPerLeaf(attributes_);
    if (choices_.output == Output::nano) bytes *= 1 + kNanoCopies;
    if (choices_.output == Output::mesh) bytes += kMeshBytesPerLeaf;
    if (choices_.interior_distance) bytes += voxelize::kSweepBytesPerLeaf;
    return bytes;
}

std::vector<std::uint32_t> LevelSetPlan::selected() {
    std::vector<std::uint32_t> all = voxelize::selectBeads(toolpath_, voxelize::selectionOf(choices_.print, toolpath_));
    if (!choices_.part_alone) return all;
    std::vector<std::uint32_t> part = gcode::beadsUpTo(gcode::Purpose::brim, purposes(), all);
    left_out_ = all.size() - part.size();
    return part;
}

const std::vector<gcode::Purpose>& LevelSetPlan::purposes() const {
    if (purposes_.empty()) purposes_ = gcode::purposesOf(toolpath_);
    return purposes_;
}

voxelize::VoxelizeOptions LevelSetPlan::voxelizeOptions() const {
    voxelize::VoxelizeOptions options;
    options.placement = placement_;
    options.interior = choices_.interior;
    options.bytes_per_leaf = bytesPerLeaf();
    return options;
}

Provenance LevelSetPlan::provenance(const std::string& source_file, const std::string& source_sha256,
                                    std::span<const std::uint32_t> printed) const {
    Provenance provenance;
    provenance.source_file = source_file;
    provenance.source_sha256 = source_sha256;
    provenance.slicer = toolpath_.slicer;
    provenance.unit = choices_.unit;
    provenance.up = choices_.up;
    provenance.selection = voxelize::describeSelection(choices_.print);
    if (left_out_ > 0) provenance.selection += provenance.selection.empty() ? "the part alone" : "; the part alone";
    if (colors_.size() == 1 && colors_.front()) provenance.filament_color = gcode::colorText(*colors_.front());
    const voxelize::Bounds part = voxelize::partBounds(toolpath_, purposes(), printed);
    provenance.part = voxelize::placed(
        placement_.tilt == 0 ? part : voxelize::partBounds(toolpath_, purposes(), printed, placement_.tilt),
        placement_);
    provenance.outline = voxelize::placed(voxelize::partOutline(toolpath_, purposes(), printed, part), placement_);
    provenance.deposit = toolpath_.deposit;
    provenance.culled = culls();
    provenance.swept = choices_.interior_distance;
    return provenance;
}

}  // namespace stratum::exporter
