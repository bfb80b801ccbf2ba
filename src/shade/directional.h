// A light so far away that its rays are parallel.
#pragma once

#include "shade/color.h"

#include <glm/vec3.hpp>

#include <string_view>

namespace stratum::shade {

/// A delta light: one direction, hard shadows. A white Lambert surface that faces it gets radiance irradiance / pi.
struct DirectionalLight {
    glm::vec3 to_light{0.0f, 0.0f, 1.0f};  ///< towards the light, unit, world space
    Color irradiance{0.0f};                ///< on a surface that faces the light
};

/// A light from the text of --light: `directional:X,Y,Z,R,G,B`, where X,Y,Z (world space, any length) is the direction
/// in which the light travels and R,G,B its irradiance. Throws UsageError.
DirectionalLight parseDirectionalLight(std::string_view text);

}  // namespace stratum::shade
