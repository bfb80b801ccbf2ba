// Draws of many samplers at once.
#pragma once

#include "shade/camera/sampler.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <span>

namespace stratum::shade {

/// draws[n] is samplers[which[n]].next2D(), to the bit, in vectors; its x is what next1D() would give.
/// @param which  all different
/// @param draws  as many as which
void next2DStream(std::span<Sampler> samplers, std::span<const std::size_t> which, std::span<glm::vec2> draws);

}  // namespace stratum::shade
