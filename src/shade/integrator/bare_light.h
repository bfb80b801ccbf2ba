// What a surface would look like by its direction alone: the light of a scene with nothing in its way.
#pragma once

#include "shade/scene/scene.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <vector>

namespace stratum::shade {

/// Two tables over the sphere, of luminance: what a white Lambert surface returns by its normal, and a blurred mirror
/// image of the light. A layer line is a normal that turns within a pixel or two; means of these over a pixel tell,
/// without the noise of sampled light, how bright that makes it. Immutable; shared by all threads.
///
/// Lamps count as seen from `center`; the bed returns what falls on it in the open. Directions are table cells of a
/// square that is folded to an octahedron, and are interpolated between. Source: Z. H. Cigolle et al., "A Survey of
/// Efficient Representations for Independent Unit Vectors", JCGT 3(2) 2014.
class BareLight {
public:
    /// @param center  a place on the print, world space
    BareLight(const SceneDescription& scene, const glm::dvec3& center);

    /// Of a white Lambert surface; 1 for the direction that gets most.
    float matt(const glm::vec3& normal) const { return at(normal).x; }
    /// Mean radiance about a direction, by the weight (wi . mirror)^16, in the same unit.
    float gloss(const glm::vec3& mirror) const { return at(mirror).y; }
    /// Radiance (relative, see color.h) that counts 1; 0 if there is no light.
    float brightest() const { return brightest_; }

private:
    glm::vec2 at(const glm::vec3& direction) const;

    std::vector<glm::vec2> table_;
    float brightest_ = 0.0f;
};

}  // namespace stratum::shade
