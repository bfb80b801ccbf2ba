// Rays from the camera through the filters of pixels, many at a time.
#pragma once

#include "shade/camera/camera.h"
#include "shade/camera/filter.h"
#include "shade/camera/sampler.h"

#include <glm/vec2.hpp>

#include <span>

namespace stratum::shade {

/// rays[n] goes through pixels[n] by the first two numbers of samplers[n], which must just have been started, and the
/// lens, if there is one, by the next two; the samplers are left behind them. The bits are those of
/// `camera.ray(pixel + 0.5 + filter.offset(sampler.next2D()))`, whatever the processor. All spans are of one length.
void primaryRays(const Camera& camera, const PixelFilter& filter, std::span<const glm::ivec2> pixels,
                 std::span<Sampler> samplers, std::span<trace::Ray> rays);

}  // namespace stratum::shade
