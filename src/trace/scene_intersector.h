// Several objects as one Intersector: the nearest hit of all, occluded by any.
#pragma once

#include "trace/intersector.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <memory>
#include <vector>

namespace stratum::trace {

/// Where an object stands: world = linear * own + offset. Own space is that of the object's file.
struct Placement {
    glm::dmat3 linear{1.0};  ///< any invertible matrix
    glm::dvec3 offset{0.0};  ///< world units

    /// Scaled along its own axes, then turned about x, then y, then z (degrees, counter-clockwise as seen from the
    /// axis' tip), then moved.
    static Placement of(const glm::dvec3& scale, const glm::dvec3& degrees, const glm::dvec3& offset);
    bool isIdentity() const;
    bool operator==(const Placement&) const = default;
};

/// One object of a scene. The same shape may stand in several places; it is held once.
struct SceneObject {
    std::shared_ptr<const Intersector> shape;
    Placement placement;
};

/// From so many objects on, a BoxTree finds those whose box a ray meets; fewer are asked one by one
/// (docs/benchmarks.md, "Pictures").
inline constexpr std::size_t kManyObjects = 8;

/// All objects as one; Hit::object is the index into `objects`, the least one where several are met at the same t. Rays
/// are mapped into each object's own space, normals back by the inverse transpose, distances are those of world space.
/// The cost of a ray grows with the number of objects whose box it meets. A single object that stands where its file
/// has it is returned as it is: nothing is added to it. Throws UsageError if there are no objects, none of them has
/// finite bounds, or a placement can't be inverted.
/// @param many  number of objects from which on there is a tree; the answers are the same with and without, to the bit
std::shared_ptr<const Intersector> makeSceneIntersector(std::vector<SceneObject> objects,
                                                        std::size_t many = kManyObjects);

}  // namespace stratum::trace
