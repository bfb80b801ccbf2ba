// Convex solids whose hits have closed forms: prisms of any number of sides, and cones with both ends cut off.
#pragma once

#include "trace/intersector.h"

#include <glm/vec3.hpp>

#include <memory>
#include <vector>

namespace stratum::trace {

/// What lies between two parallel planes.
struct Slab {
    glm::dvec3 normal{0.0};        ///< unit
    double low = 0.0, high = 0.0;  ///< low <= normal . p <= high, world units
};

/// What lies in all slabs. Throws UsageError for normals that are not of unit length, and for no thickness.
/// @param bounds  a box around it
std::unique_ptr<Intersector> makeSlabSolid(std::vector<Slab> slabs, const Box& bounds);

/// A box.
std::unique_ptr<Intersector> makeBoxSolid(const glm::dvec3& min, const glm::dvec3& max);

/// A regular hexagonal prism about the z axis, with two sides across x.
std::unique_ptr<Intersector> makeHexagonSolid(double across_flats, double low, double high);

/// About the z axis: from radius `low_radius` at z = `low` to `high_radius` at z = `high`. A cylinder if they are
/// equal. Throws UsageError for radii that are not above 0, or no height.
std::unique_ptr<Intersector> makeConeSolid(double low, double low_radius, double high, double high_radius);

}  // namespace stratum::trace
