// Points spread evenly over a surface.
#pragma once

#include "compare/triangle_mesh.h"

#include <cstddef>
#include <vector>

namespace stratum::compare {

struct SurfaceSamples {
    std::vector<glm::dvec3> points;  ///< mm; each stands for the same area
    std::vector<std::uint32_t> triangles;
    double area = 0;  ///< mm^2, of the surface
};

/// `count` points: one in each of as many equal parts of the area, taken triangle after triangle, at a place that
/// depends on the number of the part alone.
SurfaceSamples sampleSurface(const TriangleMesh& mesh, std::size_t count);

/// Every n-th, so that about `count` are left.
SurfaceSamples thinned(const SurfaceSamples& samples, std::size_t count);

/// mm: half of the surface is nearer than this to its middle; a point far away changes neither.
double spreadOf(const SurfaceSamples& samples);

}  // namespace stratum::compare
