// Cosine-distributed directions about many normals, in vectors.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <span>

namespace stratum::shade {

/// Sets directions[n], unit, to the direction about normals[n] (unit) that draws[n] in [0, 1)^2 stands for. The bits
/// are those of `glm::normalize(glm::dvec3(Frame(normal).toWorld(toCosineHemisphere(draw))))` on every processor. It is
/// zero where toCosineHemisphere is to be rejected. All spans are of one length.
void cosineDirections(std::span<const glm::vec3> normals, std::span<const glm::vec2> draws,
                      std::span<glm::dvec3> directions);

}  // namespace stratum::shade
