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
/// face's own elsewhere (Baerentzen and Aanaes, IEEE TVCG 11, 2005). A triangle without area has no normal: for its
/// neighbours it is a line, beyond which the next face lies.
class ClosedModel {
public:
    /// Throws InputError if an edge has not as many triangles in one direction as in the other (with a place of one),
    /// or if the mesh is inside out. `name` is for messages.
    ClosedModel(TriangleMesh mesh, const std::string& name);
    ClosedModel(const ClosedModel&) = delete;
    ClosedModel& operator=(const ClosedModel&) = delete;

    /// @param rough  of TriangleTree::nearest(); beyond it the sign may be wrong
    ModelDistance distance(const glm::dvec3& p, std::uint32_t hint = Nearest::kNone,
                           double rough = std::numeric_limits<double>::infinity()) const;
    /// Unit normal of a triangle, outward; of one without area that of the face beyond its longest edge.
    glm::dvec3 normal(std::uint32_t triangle) const { return normals_[triangle]; }
    const TriangleMesh& mesh() const { return mesh_; }
    const TriangleTree& tree() const { return tree_; }
    double volume() const { return volume_; }  ///< mm^3
    double area() const { return area_; }      ///< mm^2
    /// Triangles with the corners of another one: of bodies that the file has twice.
    std::size_t repeated() const { return repeated_; }

private:
    static constexpr std::uint8_t kNotFlat = 3;

    void joinEdges(const std::string& name);
    void addNormals();
    void addCornerNormals();
    void countRepeated();
    glm::dvec3 beyond(std::uint32_t triangle, std::size_t edge, const glm::dvec3& at) const;
    glm::dvec3 edgeNormal(const Nearest& nearest, std::size_t edge) const;
    glm::dvec3 lineNormal(std::uint32_t flat, const glm::dvec3& at) const;
    std::size_t shortEdge(std::uint32_t flat, const glm::dvec3& at) const;

    const TriangleMesh mesh_;
    const TriangleTree tree_;
    std::vector<glm::dvec3> normals_;                   // by triangle
    std::vector<std::uint8_t> flat_;                    // by triangle: the longest edge of one without area
    std::vector<glm::dvec3> corner_normals_;            // by point
    std::vector<std::array<std::uint32_t, 3>> beside_;  // by triangle: beyond the edge from corner n to n + 1
    double volume_ = 0, area_ = 0;
    std::size_t repeated_ = 0;
};

}  // namespace stratum::compare
