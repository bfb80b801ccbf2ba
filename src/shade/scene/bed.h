// The bed under the print and the backdrop behind it: a seamless sweep as in product photography.
#pragma once

#include "shade/color.h"
#include "shade/scene/bed_texture.h"
#include "trace/intersector.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <optional>

namespace stratum::shade {

/// The background that the camera sees: a vertical gradient. It gives no light.
struct Backdrop {
    Color horizon{0.0f};  ///< radiance at and below the horizon
    Color zenith{0.0f};   ///< radiance straight up

    /// @param direction  away from the camera, unit, world space
    Color radiance(const glm::vec3& direction) const;
};

/// An infinite horizontal sheet, one-sided: rays from below pass through.
///
/// For light it is an infinite plane. For the camera it fades into the backdrop with distance, so that there is no
/// visible horizon.
struct Bed {
    double z = 0.0;  ///< world units
    BedTexture texture{BedSurface::paper};
    glm::dvec2 center{0.0};   ///< world units: the fade is round about this point
    double fade_begin = 1.0;  ///< world units from the center: nothing faded yet
    double fade_end = 2.0;    ///< world units from the center: all faded; > fade_begin

    /// Distance along a ray to the sheet, if it is in the ray's interval and hit from above.
    std::optional<double> intersect(const trace::Ray& ray) const;
    /// Share of the backdrop, 0 to 1, in what the camera sees at this point.
    double fade(const glm::dvec3& point) const;
};

}  // namespace stratum::shade
