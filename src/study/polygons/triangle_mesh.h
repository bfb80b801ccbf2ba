// Shapes as triangles: what polygons make of the scenes that signed distances make exactly.
#pragma once

#include <glm/vec3.hpp>

#include <cstdint>
#include <filesystem>
#include <vector>

namespace stratum::study {

/// Closed; corners run counter-clockwise seen from outside.
struct TriangleMesh {
    std::vector<glm::dvec3> corners;
    std::vector<glm::uvec3> triangles;
    std::vector<std::uint32_t> objects;  ///< by triangle

    void append(const TriangleMesh& other, std::uint32_t object);
};

/// A sphere by latitude and longitude: `rings` bands from pole to pole of as many sectors each; 2 rings (rings - 1)
/// triangles. Corners lie on the sphere, so the mesh lies within it. rings >= 3.
TriangleMesh sphereMesh(const glm::dvec3& center, double radius, int rings);
/// 12 triangles.
TriangleMesh boxMesh(const glm::dvec3& center, const glm::dvec3& half_extents);
/// Along `axis` (0 x, 1 y, 2 z), with `points` >= 3 around: 4 points triangles, caps included.
TriangleMesh cylinderMesh(const glm::dvec3& center, double radius, double half_height, int axis, int points);

/// The spheres, boxes and cylinders of a scene file as one mesh. Throws InputError if it has anything else.
TriangleMesh sceneMesh(const std::filesystem::path& scene, int sphere_rings, int cylinder_points);

}  // namespace stratum::study
