// Several objects as one Intersector: the nearest hit of all, occluded by any.
#pragma once

#include "trace/intersector.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <memory>
#include <vector>

namespace stratum::trace {

/// The placement of an object: world = linear * own + offset. Own space is that of the object's file.
struct Placement {
    glm::dmat3 linear{1.0};  ///< any invertible matrix
    glm::dvec3 offset{0.0};  ///< world units

    /// Scale along its own axes, then rotation about x, then y, then z (degrees, counter-clockwise as seen from the
    /// axis' tip), then translation.
    static Placement of(const glm::dvec3& scale, const glm::dvec3& degrees, const glm::dvec3& offset);
    bool isIdentity() const;
    bool operator==(const Placement&) const = default;
};

/// One object of a scene. Several objects may share a shape (instances).
struct SceneObject {
    std::shared_ptr<const Intersector> shape;
    Placement placement;
};

/// The number of objects from which on a BoxTree is used; fewer are tested one by one (docs/benchmarks.md, "Pictures").
inline constexpr std::size_t kManyObjects = 8;

/// All objects as one; Hit::object is the index into `objects`, the least one if several are hit at the same t. Rays
/// are mapped into each object's own space, normals back by the inverse transpose, distances are those of world space.
/// The cost of a ray grows with the number of objects whose box it meets. A single object without a placement is
/// returned unchanged. Throws UsageError if there are no objects, none of them has finite bounds, or a placement can't
/// be inverted.
/// @param many  number of objects from which on there is a tree; the results are bit-identical with and without
std::shared_ptr<const Intersector> makeSceneIntersector(std::vector<SceneObject> objects,
                                                        std::size_t many = kManyObjects);

}  // namespace stratum::trace
