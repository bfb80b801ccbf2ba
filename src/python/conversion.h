// One conversion of a toolpath: the choices of gcode2vdb, and what it writes.
#pragma once

#include "python/long_call.h"
#include "python/options/keywords.h"
#include "python/toolpath_object.h"

#include "export/vdb_file.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/grid/attributes.h"
#include "voxelize/grid/print_options.h"
#include "voxelize/grid/voxelizer.h"

#include <openvdb/openvdb.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace stratum::python {

/// As gcode2vdb's options of those names.
struct ConversionOptions {
    voxelize::PrintOptions print;
    voxelize::Interior interior = voxelize::Interior::keep;
    bool interior_distance = false;
    std::optional<std::vector<voxelize::Attribute>> attributes;  ///< nothing: color, if there are several
    std::string unit = "mm", up = "z", origin = "bed";
};

/// printOptionsOf() and interior, interior_distance, grids, unit, up, origin. Throws UsageError.
ConversionOptions conversionOptionsOf(Keywords& options);

/// Beads and lattice of a conversion. Needs no GIL.
class Conversion {
public:
    /// The toolpath must outlive it. Throws UsageError, InputError.
    Conversion(const ToolpathObject& print, ConversionOptions options);

    /// The level set first, then the attributes, with the metadata of gcode2vdb.
    openvdb::GridPtrVec makeGrids(const Report& report);
    /// Writes the file that gcode2vdb writes. What needs no grid goes to the disk while it is made. Throws OutputError.
    void write(const std::filesystem::path& path, const exporter::FileOptions& file, const Report& report);

    const voxelize::Lattice& lattice() const { return lattice_; }
    const voxelize::Bounds& bounds() const { return bounds_; }
    const std::vector<std::uint32_t>& selection() const { return selection_; }

private:
    bool streams() const;
    voxelize::VoxelizeOptions voxelizeOptions(const Report& report) const;
    exporter::Provenance provenance() const;

    const ToolpathObject& print_;
    const gcode::Toolpath& toolpath_;
    ConversionOptions options_;
    std::vector<std::uint32_t> selection_;
    voxelize::Bounds bounds_;
    voxelize::Lattice lattice_;
    voxelize::Placement placement_;
    std::vector<voxelize::Attribute> attributes_;
    std::string filament_color_;
};

}  // namespace stratum::python
