// Binary glTF. Source: Khronos, glTF 2.0 specification (2.0.1).
//
// Written here, because Assimp's exporter knows no shared points with several index lists, and takes a second copy of
// the mesh.
#pragma once

#include "export/mesh/mesh_space.h"
#include "export/mesh/surface_mesh.h"

#include <cstddef>
#include <filesystem>

namespace stratum::exporter {

/// A .glb of one mesh: positions in metres, y up, shared by one primitive of triangles a material. A material's
/// baseColorFactor is linear; metallicFactor is 0. Without normals, so that readers shade faces flat. Throws UsageError
/// if the file would be larger than the 4 GiB that the format can count, OutputError.
void writeGlb(const SurfaceMesh& mesh, const std::filesystem::path& path, const MeshSpace& space);

/// Throws UsageError, with the path, if a mesh of so many points and triangles does not fit.
void requireGlbSize(std::size_t points, std::size_t triangles, const std::filesystem::path& path);

}  // namespace stratum::exporter
