// A mesh as text of USD. Source: Pixar's schemas UsdGeom (Mesh, GeomSubset), UsdShade and UsdPreviewSurface.
#pragma once

#include "export/mesh/mesh_space.h"
#include "export/mesh/surface_mesh.h"

#include <filesystem>
#include <span>
#include <string>

namespace stratum::exporter {

/// A scope "materials" under `parent` with a UsdPreviewSurface of each, colors linear. Empty for none.
std::string usdMaterials(std::span<const MeshMaterial> materials, const std::string& parent);

/// A .usda of one UsdGeomMesh, polygons without subdivision, quads kept. Of several materials each has a GeomSubset of
/// the family materialBind. Throws UsageError for more than 2^31 - 1 corners or points, which USD's int can't count;
/// OutputError.
void writeUsdMesh(const SurfaceMesh& mesh, const std::filesystem::path& path, const MeshSpace& space);

}  // namespace stratum::exporter
