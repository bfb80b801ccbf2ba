// The point of a mesh that is nearest to a place: a tree of boxes over its triangles.
#pragma once

#include "compare/triangle_mesh.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace stratum::compare {

struct Nearest {
    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

    std::uint32_t triangle = kNone;  ///< one that has the point
    glm::dvec3 point{0.0};
    double distance2 = std::numeric_limits<double>::infinity();  ///< mm^2
    /// What of the triangle has the point: bit n is set where corner n counts. One bit is a corner, two an edge, three
    /// the face.
    std::uint8_t feature = 0;
    std::uint32_t looked_at = 0;  ///< triangles and boxes of the tree, until it was found
};

/// The point of a triangle that is nearest to p. Source: the regions of Voronoi of a triangle's corners, edges and
/// face.
Nearest nearestOn(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

/// Immutable; shared by all threads. Boxes are split at the median of the middles along their longest side. A leaf has
/// triangles that follow one another in the mesh and share corners. The mesh must outlive it.
class TriangleTree {
public:
    /// @param leaf  the most triangles of a leaf: more make the tree sooner, and searches a little longer
    explicit TriangleTree(const TriangleMesh& mesh, std::uint32_t leaf = 4);

    /// @param hint  a triangle that is probably near, e.g. that of a place beside this one: saves most of the search
    /// @param rough  mm: beyond this distance a point that is a hundredth farther will do. From afar all triangles of a
    /// flat side are nearly as near, and an exact answer would look at each.
    Nearest nearest(const glm::dvec3& p, std::uint32_t hint = Nearest::kNone,
                    double rough = std::numeric_limits<double>::infinity()) const;
    const TriangleMesh& mesh() const { return mesh_; }
    std::size_t bytes() const { return nodes_.size() * sizeof(Node); }

private:
    struct Node {
        float low[3], high[3];     // rounded outward
        std::uint32_t begin, end;  // triangles; of leaves alone
        std::uint32_t right;       // the left child is the next node; 0 for leaves
    };
    struct Run {
        std::array<float, 3> middle;
        std::uint32_t begin, end;  // triangles
    };
    std::vector<Run> runs(std::uint32_t leaf) const;
    std::uint32_t build(std::span<Run> runs);
    Node leafOf(const Run& run) const;
    void test(std::uint32_t triangle, const glm::dvec3& p, Nearest& best) const;
    static double distance2(const Node& node, const glm::dvec3& p);

    const TriangleMesh& mesh_;
    std::vector<Node> nodes_;
};

}  // namespace stratum::compare
