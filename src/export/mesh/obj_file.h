// Wavefront OBJ, and the .mtl beside it. Source: M. Reddy's copies of Wavefront's "Object Files" and "MTL" appendices.
#pragma once

#include "export/mesh/surface_mesh.h"

#include <filesystem>

namespace stratum::exporter {

/// The .mtl that a .obj with materials names.
std::filesystem::path mtlOf(std::filesystem::path obj);

/// Quads and triangles of shared points. With materials also a .mtl: `Kd` of each in linear light, as renderers read
/// it, and a comment with the sRGB value; the faces are ordered by material, with `usemtl` before each group. Both
/// files are written whole or not at all; the .mtl gets its name first. Throws UsageError for materials on standard
/// output, OutputError.
void writeObj(const SurfaceMesh& mesh, const std::filesystem::path& path);

}  // namespace stratum::exporter
