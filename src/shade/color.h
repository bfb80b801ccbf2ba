// Color as the renderer computes with it.
#pragma once

#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>

namespace stratum::shade {

/// Linear light in Rec. 709 / sRGB primaries with a D65 white. Radiance, irradiance or reflectance, as each use states.
///
/// Radiance is relative: under `--env constant:1,1,1` a white surface has radiance 1; in the built-in studio a white
/// surface that faces up has 1.5. A measured environment keeps the unit of its file.
using Color = glm::vec3;

/// Relative luminance (Rec. 709 weights).
inline float luminance(const Color& c) { return 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b; }

inline float maxComponent(const Color& c) { return std::max({c.r, c.g, c.b}); }

inline bool isFinite(const Color& c) { return std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b); }

}  // namespace stratum::shade
