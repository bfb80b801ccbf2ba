// .stl, .3mf, .obj -> TriangleMesh, by Assimp.
#pragma once

#include "compare/triangle_mesh.h"

#include <filesystem>

namespace stratum::compare {

constexpr std::size_t kMostTriangles = 50'000'000;

/// Whether the name is one of a model: .stl, .3mf or .obj, in any case.
bool isModelPath(const std::filesystem::path& path);

/// All bodies of the file as one mesh, in the file's coordinates, in mm: see unitOfModel(). Equal points are one point;
/// triangles without area are left out. Throws InputError: no such file, another format, nothing in it, a coordinate
/// that is not finite, too many triangles.
TriangleMesh readModel(const std::filesystem::path& path);

}  // namespace stratum::compare
