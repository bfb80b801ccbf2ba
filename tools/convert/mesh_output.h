// Meshes of gcode2vdb: what they hold of colours, and where it comes from.
#pragma once

#include "convert/conversion.h"

#include "export/mesh/surface_mesh.h"
#include "gcode/toolpath/toolpath.h"
#include "voxelize/grid/attributes.h"

#include <openvdb/openvdb.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace stratum::tools {

/// Throws UsageError for --grids that the mesh's format can't hold. Before the work.
void checkMeshGrids(const ConvertCommand& command, const std::filesystem::path& output);

/// Tells the run of an output, and of the .mtl that a coloured .obj has beside it. Throws UsageError as
/// RunFiles::writes() does.
void noteOutput(const ConvertCommand& command, const std::filesystem::path& output, std::string_view option,
                RunFiles& files);

/// The attributes that its points need: color and tool, if there are several, and the format holds them by default or
/// --grids or --color asks for them. Nothing if one material is enough.
std::vector<voxelize::Attribute> meshAttributes(const ConvertCommand& command, const gcode::Toolpath& toolpath,
                                                std::span<const std::uint32_t> selection,
                                                const std::filesystem::path& output);

/// A material a tool and color of the selected beads, in the order of their first use; those without a stated color
/// are left out.
std::vector<exporter::MeshMaterial> materialsOf(const gcode::Toolpath& toolpath,
                                                std::span<const std::uint32_t> selection);

/// The mesh of a level set with its materials. `grids` are those of meshAttributes().
exporter::SurfaceMesh meshOf(const ConvertCommand& command, const openvdb::FloatGrid& grid,
                             const openvdb::GridPtrVec& grids, bool culled,
                             const std::vector<exporter::MeshMaterial>& materials, const std::filesystem::path& output);

}  // namespace stratum::tools
