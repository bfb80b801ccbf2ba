// Points spread evenly over a surface.
#pragma once

#include "compare/closed_model.h"

#include <cstddef>
#include <vector>

namespace stratum::compare {

struct SurfaceSamples {
    std::vector<glm::dvec3> points;  ///< mm; each stands for the same area
    std::vector<std::uint32_t> triangles;
    double area = 0;  ///< mm^2, of the surface
};

/// Samples of one surface, of any number. The mesh must outlive it.
class SurfaceSampler {
public:
    explicit SurfaceSampler(const TriangleMesh& mesh);

    /// `count` points: one in each of as many equal parts of the area, taken triangle after triangle, at a place that
    /// depends on the number of the part alone.
    SurfaceSamples operator()(std::size_t count) const;

private:
    const TriangleMesh& mesh_;
    std::vector<double> until_;  // mm^2, of all triangles up to this one
};

/// Of a surface that is sampled once.
SurfaceSamples sampleSurface(const TriangleMesh& mesh, std::size_t count);

/// Every n-th, so that about `count` are left.
SurfaceSamples thinned(const SurfaceSamples& samples, std::size_t count);

/// mm: half of the surface is nearer than this to its middle; a point far away changes neither.
double spreadOf(const SurfaceSamples& samples);

}  // namespace stratum::compare
