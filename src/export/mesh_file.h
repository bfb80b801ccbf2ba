// FloatGrid -> a closed polygon mesh of its zero level -> .stl, .ply or .obj, written whole or not at all.
#pragma once

#include "export/surface_mesh.h"

#include <filesystem>

namespace stratum::exporter {

/// Whether writeMesh knows the extension: .stl, .ply or .obj, in any case.
bool isMeshPath(const std::filesystem::path& path);

/// Whether it writes SurfaceMesh::colors to this path: to .ply.
bool meshHasColors(const std::filesystem::path& path);

/// Writes by the extension: binary STL (triangles), binary PLY or OBJ text (quads and triangles, shared vertices), a
/// megabyte at a time. PLY has the points' colors, if there are any. Throws UsageError if the mesh has more faces than
/// the format allows, OutputError if it can't be written; the old file then stays.
void writeMesh(const SurfaceMesh& mesh, const std::filesystem::path& path);

}  // namespace stratum::exporter
