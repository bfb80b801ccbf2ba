// Simplifies a surface mesh within a given error.
#pragma once

#include "export/mesh/surface_mesh.h"

#include <cstdint>
#include <span>

namespace stratum::exporter {

/// Collapses edges where the surface is flat or curved in one direction only. After M. Garland and P. Heckbert,
/// "Surface Simplification Using Quadric Error Metrics" (SIGGRAPH 97), with planes weighted by area: the root mean
/// square distance of a point from the planes of the faces that it represents stays below 0.45 `error` (world units).
/// That is no bound of the largest distance, which was measured to be below 1.2 `error` and a twentieth of a voxel.
///
/// A closed mesh stays closed and keeps its genus: only edges of two faces, whose ends have two neighbours in common,
/// are collapsed, and no face turns by more than about 70 degrees at a step. Quads become triangles. `labels`, one a
/// point or none: where two of them meet, points stay where they are. Points keep their labels' order: those of the
/// result are returned. Single-threaded; the same result on every machine with IEEE doubles.
std::vector<std::uint32_t> simplify(SurfaceMesh& mesh, double error, std::span<const std::uint32_t> labels = {});

}  // namespace stratum::exporter
