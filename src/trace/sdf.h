// Shapes by formula: signed distance functions and what can be made of them.
//
// Negative inside. After J. C. Hart, "Sphere Tracing" (The Visual Computer 12, 1996), and the usual closed forms of
// boxes, cylinders and tori; the choice of shapes and operations is that of Roukema, "SDFs versus polygons", 2023.
#pragma once

#include "trace/intersector.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <memory>
#include <vector>

namespace stratum::trace {

/// Immutable; shared by all threads. World units.
class Sdf {
public:
    virtual ~Sdf() = default;
    /// Never farther from the surface than |distance| says, so that a step of that length meets nothing: the distance
    /// itself for shapes, their unions, turns and repetitions from outside; a lower bound inside unions, and for
    /// intersections and subtractions.
    virtual double distance(const glm::dvec3& point) const = 0;
    /// Encloses the surface; infinite along axes on which it has no end.
    virtual Box bounds() const = 0;
};

using SdfPtr = std::shared_ptr<const Sdf>;

/// All throw UsageError for sizes that are not from 1e-60 to 1e60, places beyond that, and operations on nothing.
SdfPtr sdfSphere(const glm::dvec3& center, double radius);
SdfPtr sdfBox(const glm::dvec3& center, const glm::dvec3& half_extents);
/// A ring about `axis` (0 x, 1 y, 2 z): `radius` to the middle of the tube, whose own radius is `tube`.
SdfPtr sdfTorus(const glm::dvec3& center, double radius, double tube, int axis);
/// Round and capped, along `axis`.
SdfPtr sdfCylinder(const glm::dvec3& center, double radius, double half_height, int axis);
/// The half space below: inside is where normal . p < offset, for the unit vector along `normal`.
SdfPtr sdfPlane(const glm::dvec3& normal, double offset);

SdfPtr sdfUnion(std::vector<SdfPtr> parts);
SdfPtr sdfIntersection(std::vector<SdfPtr> parts);
/// The first less all others.
SdfPtr sdfSubtraction(std::vector<SdfPtr> parts);
/// Turned about the origin by a rotation matrix, then moved. Throws UsageError if it is no rotation.
SdfPtr sdfMoved(SdfPtr part, const glm::dmat3& rotation, const glm::dvec3& offset);
/// Again and again at every multiple of `period`; 0 along axes on which it is not repeated. `count` is how many there
/// are to each side of the first, or less than 0 for no end. Copies must not reach into each other: throws UsageError
/// if the part is wider than a period or lies farther than half of one from the origin.
SdfPtr sdfRepetition(SdfPtr part, const glm::dvec3& period, int count);

}  // namespace stratum::trace
