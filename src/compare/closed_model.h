// A closed model, and signed distances from it.
#pragma once

#include "compare/nearest_triangle.h"
#include "compare/triangle_mesh.h"

#include <string>
#include <vector>

namespace stratum::compare {

/// Signed distance of a place from the model.
struct ModelDistance {
    double distance = 0;  ///< mm; positive outside
    std::uint32_t triangle = Nearest::kNone;
    glm::dvec3 point{0.0};  ///< of the model
};

/// Immutable; shared by all threads. Signs are those of the angle-weighted normal of the nearest corner or edge, the
/// face's own elsewhere (Baerentzen and Aanaes, IEEE TVCG 11, 2005).
class ClosedModel {
public:
    /// Throws InputError if an edge has not as many triangles in one direction as in the other (with a place of one),
    /// or if the mesh is inside out. `name` is for messages.
    ClosedModel(TriangleMesh mesh, const std::string& name);
    ClosedModel(const ClosedModel&) = delete;
    ClosedModel& operator=(const ClosedModel&) = delete;

    ModelDistance distance(const glm::dvec3& p, std::uint32_t hint = Nearest::kNone) const;
    /// Unit normal of a triangle, outward.
    glm::dvec3 normal(std::uint32_t triangle) const { return normals_[triangle]; }
    const TriangleMesh& mesh() const { return mesh_; }
    double volume() const { return volume_; }  ///< mm^3
    double area() const { return area_; }      ///< mm^2

private:
    void joinEdges(const std::string& name);

    const TriangleMesh mesh_;
    const TriangleTree tree_;
    std::vector<glm::dvec3> normals_;                   // by triangle
    std::vector<glm::dvec3> corner_normals_;            // by point
    std::vector<std::array<std::uint32_t, 3>> beside_;  // by triangle: beyond the edge from corner n to n + 1
    double volume_ = 0, area_ = 0;
};

}  // namespace stratum::compare
