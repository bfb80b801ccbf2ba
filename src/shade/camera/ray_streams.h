// Samples of many pixels in vectors.
#pragma once

#include "shade/camera/camera.h"
#include "shade/camera/filter.h"
#include "shade/camera/sampler.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <span>

namespace stratum::shade {

// Camera rays through the reconstruction filters of pixels, many at a time.

/// Sets rays[n] to a ray through pixels[n]. The position in the pixel is from the first two numbers of samplers[n],
/// which must just have been started; the position on the lens, if there is one, is from the next two. The samplers
/// advance past them. The bits are those of `camera.ray(pixel + 0.5 + filter.offset(sampler.next2D()))` on every
/// processor. All spans are of one length.
void primaryRays(const Camera& camera, const PixelFilter& filter, std::span<const glm::ivec2> pixels,
                 std::span<Sampler> samplers, std::span<trace::Ray> rays);

/// A ray through a place of the frame, and of the lens if there is one, that the next numbers of the sampler choose.
trace::Ray anyPrimaryRay(const Camera& camera, Sampler& sampler);

// Draws of many samplers at once.

/// draws[n] is samplers[which[n]].next2D(), to the bit, in vectors; its x is what next1D() would give.
/// @param which  all different
/// @param draws  as many as which
void next2DStream(std::span<Sampler> samplers, std::span<const std::size_t> which, std::span<glm::vec2> draws);

// Cosine-distributed directions about many normals, in vectors.

/// Sets directions[n], unit, to the direction about normals[n] (unit) that draws[n] in [0, 1)^2 stands for. The bits
/// are those of `glm::normalize(glm::dvec3(Frame(normal).toWorld(toCosineHemisphere(draw))))` on every processor. It is
/// zero where toCosineHemisphere is to be rejected. All spans are of one length.
void cosineDirections(std::span<const glm::vec3> normals, std::span<const glm::vec2> draws,
                      std::span<glm::dvec3> directions);

}  // namespace stratum::shade
