// Unoccluded light of a scene by the normal of a surface.
#pragma once

#include "shade/scene/scene.h"

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
    /// @param glints  make glint(), too
    BareLight(const SceneDescription& scene, const glm::dvec3& center, bool glints = false);

    /// Radiance of a white Lambert surface, relative to that of the brightest normal.
    float matt(const glm::vec3& normal) const { return at(matt_, normal); }
    /// Mean radiance about a direction, by the weight (wi . mirror)^16, in the same unit.
    float gloss(const glm::vec3& mirror) const { return at(gloss_, mirror); }
    /// The same by (wi . mirror)^128, as narrow as the reflection of a flake of glitter; 0 if it was not asked for.
    float glint(const glm::vec3& mirror) const { return glints_.empty() ? 0.0f : at(glints_, mirror); }
    /// Radiance (relative, see color.h) of the brightest normal; 0 if there is no light.
    float brightest() const { return brightest_; }

    /// The direction of a point of the octahedral square, [-1, 1]^2.
    static glm::vec3 unfolded(float u, float v);

private:
    static float at(const std::vector<float>& table, const glm::vec3& direction);

    std::vector<float> matt_, gloss_;
    std::vector<float> glints_;  // may be empty
    float brightest_ = 0.0f;
};

}  // namespace stratum::shade
