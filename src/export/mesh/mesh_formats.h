// Files of meshes with materials: .obj, .3mf, .usda and .glb.
#pragma once

#include "base/srgb.h"
#include "export/mesh/mesh_space.h"
#include "export/mesh/surface_mesh.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace stratum::exporter {

// Wavefront OBJ, and the .mtl beside it. Source: M. Reddy's copies of Wavefront's "Object Files" and "MTL" appendices.

/// The .mtl that a .obj with materials names.
std::filesystem::path mtlOf(std::filesystem::path obj);

/// Quads and triangles of shared points. With materials also a .mtl: `Kd` of each in linear light, as renderers read
/// it, and a comment with the sRGB value; the faces are ordered by material, with `usemtl` before each group. Both
/// files are written whole or not at all; the .mtl gets its name first. Throws UsageError for materials on standard
/// output, OutputError.
void writeObj(const SurfaceMesh& mesh, const std::filesystem::path& path);

// 3MF. Source: 3MF Consortium, "3MF Core Specification" 1.2 (package, units, base materials).
//
// Written with libzip and not by lib3mf, whose files hold random identifiers and the time: the same print must give the
// same bytes. The tests read them with lib3mf.

/// One object of triangles, z up, in the unit of the mesh, with a base material (name and display color) a material.
/// The compressed file is in memory until it is whole. Throws UsageError for more than 2^31 - 1 points or triangles, as
/// the specification allows; OutputError.
void write3mf(const SurfaceMesh& mesh, const std::filesystem::path& path, const MeshSpace& space);

// A mesh as text of USD. Source: Pixar's schemas UsdGeom (Mesh, GeomSubset), UsdShade and UsdPreviewSurface.

/// A scope "materials" under `parent` with a UsdPreviewSurface of each, colors linear. Empty for none.
std::string usdMaterials(std::span<const MeshMaterial> materials, const std::string& parent);

/// A .usda of one UsdGeomMesh, polygons without subdivision, quads kept. Of several materials each has a GeomSubset of
/// the family materialBind. Throws UsageError for more than 2^31 - 1 corners or points, which USD's int can't count;
/// OutputError.
void writeUsdMesh(const SurfaceMesh& mesh, const std::filesystem::path& path, const MeshSpace& space);

// Binary glTF. Source: Khronos, glTF 2.0 specification (2.0.1).
//
// Written here, because Assimp's exporter knows no shared points with several index lists, and takes a second copy of
// the mesh.

/// A .glb of one mesh: positions in metres, y up, shared by one primitive of triangles a material. A material's
/// baseColorFactor is linear; metallicFactor is 0. Without normals, so that readers shade faces flat. Throws UsageError
/// if the file would be larger than the 4 GiB that the format can count, OutputError.
void writeGlb(const SurfaceMesh& mesh, const std::filesystem::path& path, const MeshSpace& space);

/// Throws UsageError, with the path, if a mesh of so many points and triangles does not fit.
void requireGlbSize(std::size_t points, std::size_t triangles, const std::filesystem::path& path);

// sRGB as formats of renderers want it.

/// Linear light of an sRGB color, each in [0, 1].
inline std::array<double, 3> linearOf(const std::array<std::uint8_t, 3>& srgb) {
    std::array<double, 3> linear{};
    for (std::size_t n = 0; n < 3; ++n) linear[n] = linearOfSrgb(srgb[n] / 255.0);
    return linear;
}

/// Roughness of plastic in formats that have one: the square of it is the default material's GGX alpha, 0.22.
inline constexpr double kPlasticRoughness = 0.47;

}  // namespace stratum::exporter
