// Unoccluded light of a scene by the normal of a surface.
#pragma once

#include "shade/scene/scene.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <vector>

namespace stratum::shade {

/// Two tables of luminance over the sphere: the radiance of a white Lambert surface by its normal, and a blurred mirror
/// image of the light. Across a layer line the normal turns within a pixel or two; the mean of a table over a pixel
/// estimates how bright the line is, without the noise of sampled light. Immutable; shared by all threads.
///
/// Lights are evaluated at `center`; the bed reflects its unoccluded irradiance. Directions use the octahedral map of
/// the unit square, with bilinear interpolation. Source: Z. H. Cigolle et al., "A Survey of Efficient Representations
/// for Independent Unit Vectors", JCGT 3(2) 2014.
class BareLight {
public:
    /// @param center  a point on the print, world space
    BareLight(const SceneDescription& scene, const glm::dvec3& center);

    /// Radiance of a white Lambert surface, relative to that of the brightest normal.
    float matt(const glm::vec3& normal) const { return at(normal).x; }
    /// Mean radiance about a direction, by the weight (wi . mirror)^16, in the same unit.
    float gloss(const glm::vec3& mirror) const { return at(mirror).y; }
    /// Radiance (relative, see color.h) of the brightest normal; 0 if there is no light.
    float brightest() const { return brightest_; }

private:
    glm::vec2 at(const glm::vec3& direction) const;

    std::vector<glm::vec2> table_;
    float brightest_ = 0.0f;
};

}  // namespace stratum::shade
