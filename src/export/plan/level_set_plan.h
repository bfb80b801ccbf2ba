// What a level set is made of: beads, lattice, grids and metadata. The choices of gcode2vdb, for Python as well.
#pragma once

#include "export/vdb_file.h"
#include "gcode/slicer/bead_colors.h"
#include "gcode/toolpath/purpose.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/lattice.h"
#include "voxelize/beads/placement.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/attributes.h"
#include "voxelize/grid/print_options.h"
#include "voxelize/grid/voxelizer.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace stratum::exporter {

/// What the level set is written as. Each holds more than the grids while it writes, but for .vdb files.
enum class Output : std::uint8_t { vdb, nano, mesh };

/// As gcode2vdb's options of those names.
struct LevelSetChoices {
    voxelize::PrintOptions print;
    voxelize::Interior interior = voxelize::Interior::keep;
    bool interior_distance = false;
    /// Without what is printed beside the part (gcode::Purpose::beside): skirts, towers. All of it if nothing else is
    /// left.
    bool part_alone = false;
    std::optional<std::vector<voxelize::Attribute>> attributes;  ///< nothing: color, if the beads have several
    std::string unit = "mm", up = "z", origin = "bed";
    Output output = Output::vdb;
};

/// The choices for one toolpath. Immutable.
class LevelSetPlan {
public:
    /// The toolpath must outlive it. Throws UsageError, InputError.
    LevelSetPlan(const gcode::Toolpath& toolpath, LevelSetChoices choices);

    const LevelSetChoices& choices() const { return choices_; }
    const std::vector<std::uint32_t>& selection() const { return selection_; }
    const voxelize::Bounds& bounds() const { return bounds_; }
    /// Of the print as it lies in the world, mm: turned on a belt.
    const voxelize::Bounds& lyingBounds() const { return lying_; }
    const voxelize::Lattice& lattice() const { return lattice_; }
    const voxelize::Placement& placement() const { return placement_; }
    /// With LevelSetChoices::part_alone: how many of the selected beads that leaves out.
    std::size_t leftOut() const { return left_out_; }
    /// The grids beside the level set.
    const std::vector<voxelize::Attribute>& attributes() const { return attributes_; }
    /// How many colors of filament the beads have; one that is not stated counts.
    std::size_t colors() const { return colors_.size(); }
    /// Whether a color grid is among the attributes that nobody asked for.
    bool addsColor() const { return !choices_.attributes && colors_.size() > 1; }
    bool culls() const { return choices_.interior == voxelize::Interior::cull; }
    /// Whether the file can be written while its leaves are made: nothing that was chosen needs the grid in memory.
    bool streams() const { return !culls() && attributes_.empty() && !choices_.interior_distance; }

    voxelize::VoxelizeOptions voxelizeOptions() const;
    /// Metadata of a level set of these beads of the selection. From one thread at a time.
    /// @param source_file, source_sha256  of the G-code, as Provenance has them
    Provenance provenance(const std::string& source_file, const std::string& source_sha256,
                          std::span<const std::uint32_t> printed) const;

private:
    std::vector<std::uint32_t> selected();
    std::vector<voxelize::Attribute> chosenAttributes() const;
    double bytesPerLeaf() const;
    const std::vector<gcode::Purpose>& purposes() const;

    const gcode::Toolpath& toolpath_;
    LevelSetChoices choices_;
    mutable std::vector<gcode::Purpose> purposes_;  // by bead, once they are needed
    std::size_t left_out_ = 0;
    std::vector<std::uint32_t> selection_;
    voxelize::Bounds bounds_;
    std::vector<std::optional<gcode::Rgb>> colors_;
    std::vector<voxelize::Attribute> attributes_;
    voxelize::Lattice lattice_;
    voxelize::Bounds lying_;
    voxelize::Placement placement_;
};

}  // namespace stratum::exporter
