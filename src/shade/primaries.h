// From other color spaces to the project's, linear Rec. 709 (color.h).
#pragma once

#include "shade/color.h"

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <optional>
#include <span>

namespace stratum::shade {

/// CIE XYZ with a D65 white to linear Rec. 709 (IEC 61966-2-1).
inline glm::dvec3 fromXyz(double x, double y, double z) {
    return {3.2406 * x - 1.5372 * y - 0.4986 * z, -0.9689 * x + 1.8758 * y + 0.0415 * z,
            0.0557 * x - 0.2040 * y + 1.0570 * z};
}

/// CIE 1931 chromaticities x, y of a picture's primaries and its white; the defaults are Rec. 709's.
struct Primaries {
    glm::dvec2 red{0.64, 0.33}, green{0.30, 0.60}, blue{0.15, 0.06}, white{0.3127, 0.3290};
};

/// The matrix from linear values in these primaries to Rec. 709's; white stays white (Bradford's adaptation, Lam 1985).
/// Nothing where they are Rec. 709's, to 0.001, or span no triangle.
std::optional<glm::dmat3> toRec709(const Primaries& primaries);

/// Multiplies them by it. What lies outside of Rec. 709 loses what is negative.
void convert(std::span<Color> colors, const glm::dmat3& to_rec709);

}  // namespace stratum::shade
