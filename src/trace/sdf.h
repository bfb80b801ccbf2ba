// Analytic signed distance functions (SDFs), and operations on them.
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
    /// |distance| is a lower bound of the distance to the surface, so a step of that length crosses nothing. It is
    /// exact for shapes, their unions, rotations and repetitions from outside; a lower bound inside unions, and for
    /// intersections and subtractions.
    virtual double distance(const glm::dvec3& point) const = 0;
    /// A box around the surface; infinite along axes on which it is unbounded.
    virtual Box bounds() const = 0;
};

using SdfPtr = std::shared_ptr<const Sdf>;

/// All throw UsageError for sizes outside [1e-60, 1e60], positions beyond that, and operations without operands.
SdfPtr sdfSphere(const glm::dvec3& center, double radius);
SdfPtr sdfBox(const glm::dvec3& center, const glm::dvec3& half_extents);
/// A torus about `axis` (0 x, 1 y, 2 z): `radius` to the middle of the tube, whose own radius is `tube`.
SdfPtr sdfTorus(const glm::dvec3& center, double radius, double tube, int axis);
/// A capped cylinder along `axis`.
SdfPtr sdfCylinder(const glm::dvec3& center, double radius, double half_height, int axis);
/// The half space below: inside is where normal . p < offset, for the unit vector along `normal`.
SdfPtr sdfPlane(const glm::dvec3& normal, double offset);

SdfPtr sdfUnion(std::vector<SdfPtr> parts);
SdfPtr sdfIntersection(std::vector<SdfPtr> parts);
/// The first less all others.
SdfPtr sdfSubtraction(std::vector<SdfPtr> parts);
/// Rotated about the origin by a matrix, then translated. Throws UsageError if the matrix is not a rotation.
SdfPtr sdfMoved(SdfPtr part, const glm::dmat3& rotation, const glm::dvec3& offset);
/// Repeated at every multiple of `period`; 0 along axes without repetition. `count` is the number of copies on each
/// side of the first, or negative for infinitely many. Copies must not overlap: throws UsageError if the part is wider
/// than a period or extends farther than half of one from the origin.
SdfPtr sdfRepetition(SdfPtr part, const glm::dvec3& period, int count);

}  // namespace stratum::trace
