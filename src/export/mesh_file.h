// A closed polygon mesh -> .stl, .ply, .obj, .3mf, .glb or .usda, written whole or not at all.
#pragma once

#include "export/mesh/mesh_space.h"
#include "export/mesh/surface_mesh.h"

#include <cstdint>
#include <filesystem>
#include <optional>

namespace stratum::exporter {

/// Whether writeMesh knows the extension, in any case.
bool isMeshPath(const std::filesystem::path& path);

/// How a format holds SurfaceMesh::materials.
enum class MeshColors : std::uint8_t {
    none,                ///< .stl
    points,              ///< .ply: a color a point, if there are several
    optional_materials,  ///< .obj: in a second file, which is there only if asked for
    materials            ///< .3mf, .glb, .usda
};
MeshColors meshColors(const std::filesystem::path& path);

/// The second file that writeMesh may write beside the first: the .mtl of a .obj.
std::optional<std::filesystem::path> meshCompanion(const std::filesystem::path& path);

/// Writes by the extension: binary STL (triangles), binary PLY (quads and triangles, shared points), or a format of
/// mesh/, which tells what it holds. STL, PLY and OBJ have the numbers of the points as they are. Throws UsageError if
/// the mesh has more faces than the format allows, OutputError if it can't be written; the old file then stays.
void writeMesh(const SurfaceMesh& mesh, const std::filesystem::path& path, const MeshSpace& space = {});

}  // namespace stratum::exporter
