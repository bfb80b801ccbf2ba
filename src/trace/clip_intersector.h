// A shape cut by planes, with its cut closed: a section.
#pragma once

#include "trace/intersector.h"

#include <glm/vec3.hpp>

#include <memory>
#include <vector>

namespace stratum::trace {

/// The plane of the points p with dot(normal, p) = offset.
struct ClipPlane {
    glm::dvec3 normal{0.0, 0.0, 1.0};  ///< world space, not zero; towards what is cut away
    double offset = 0.0;               ///< world units, if the normal is of unit length
};

/// What of `shape`, which must be closed, lies where dot(normal, p) <= offset for all planes. A cut through its inside
/// is a flat surface with the plane's normal, met from outside and from inside; it has the attributes of that place.
/// Returns `shape` itself if there are no planes. Throws UsageError for normals that are zero or not finite.
std::shared_ptr<const Intersector> makeClipIntersector(std::shared_ptr<const Intersector> shape,
                                                       std::vector<ClipPlane> planes);

}  // namespace stratum::trace
