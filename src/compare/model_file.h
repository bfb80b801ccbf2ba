// .stl, .3mf, .obj -> TriangleMesh, by Assimp.
#pragma once

#include "compare/closed_model.h"

#include <filesystem>

namespace stratum::compare {

// The unit of a model file's numbers.

/// mm a unit. A .3mf states it (the attribute `unit` of its model; without one it is millimetres, as 3MF has it); .stl
/// and .obj have none, and are taken as mm. Throws InputError for a unit that 3MF does not have.
double unitOfModel(const std::filesystem::path& path);

constexpr std::size_t kMostTriangles = 50'000'000;

/// Whether the name is one of a model: .stl, .3mf or .obj, in any case.
bool isModelPath(const std::filesystem::path& path);

/// All bodies of the file as one mesh, in the file's coordinates, in mm: see unitOfModel(). Equal points are one point;
/// triangles without area are left out. Throws InputError: no such file, another format, nothing in it, a coordinate
/// that is not finite, too many triangles.
TriangleMesh readModel(const std::filesystem::path& path);

}  // namespace stratum::compare
