// A closed model, and signed distances from it.
#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace stratum::compare {

// A polygon model: what a print was meant to be.

using Triangle = std::array<std::uint32_t, 3>;

/// Points in mm. Corners of a triangle run counter-clockwise seen from outside.
struct TriangleMesh {
    std::vector<glm::dvec3> points;
    std::vector<Triangle> triangles;

    glm::dvec3 corner(const Triangle& triangle, std::size_t n) const { return points[triangle[n]]; }
    /// Twice the area, along the normal.
    glm::dvec3 areaNormal(const Triangle& triangle) const;
};

// The point of a mesh that is nearest to a place: a tree of boxes over its triangles.

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
