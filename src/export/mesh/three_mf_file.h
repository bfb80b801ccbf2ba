// 3MF. Source: 3MF Consortium, "3MF Core Specification" 1.2 (package, units, base materials).
//
// Written with libzip and not by lib3mf, whose files hold random identifiers and the time: the same print must give the
// same bytes. The tests read them with lib3mf.
#pragma once

#include "export/mesh/mesh_space.h"
#include "export/mesh/surface_mesh.h"

#include <filesystem>

namespace stratum::exporter {

/// One object of triangles, z up, in the unit of the mesh, with a base material (name and display color) a material.
/// The compressed file is in memory until it is whole. Throws UsageError for more than 2^31 - 1 points or triangles, as
/// the specification allows; OutputError.
void write3mf(const SurfaceMesh& mesh, const std::filesystem::path& path, const MeshSpace& space);

}  // namespace stratum::exporter
