// Camera rays through the reconstruction filters of pixels, many at a time.
#pragma once

#include "shade/camera/camera.h"
#include "shade/camera/filter.h"
#include "shade/camera/sampler.h"

#include <glm/vec2.hpp>

#include <span>

namespace stratum::shade {

/// Sets rays[n] to a ray through pixels[n]. The position in the pixel is from the first two numbers of samplers[n],
/// which must just have been started; the position on the lens, if there is one, is from the next two. The samplers
/// advance past them. The bits are those of `camera.ray(pixel + 0.5 + filter.offset(sampler.next2D()))` on every
/// processor. All spans are of one length.
void primaryRays(const Camera& camera, const PixelFilter& filter, std::span<const glm::ivec2> pixels,
                 std::span<Sampler> samplers, std::span<trace::Ray> rays);

/// A ray through a place of the frame, and of the lens if there is one, that the next numbers of the sampler choose.
trace::Ray anyPrimaryRay(const Camera& camera, Sampler& sampler);

}  // namespace stratum::shade
