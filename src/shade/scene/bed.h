// What the print stands on and what is behind it: a photographer's seamless sweep.
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

/// An infinite horizontal sheet. Seen from above only: from below it isn't there.
///
/// Light sees an endless plane. The camera sees it fade into the backdrop with distance, so that sheet and
/// backdrop are one sweep without a horizon.
struct Bed {
    double z = 0.0;  ///< world units
    BedTexture texture{BedSurface::paper};
    glm::dvec2 centre{0.0};   ///< world units: the fade is round about this point
    double fade_begin = 1.0;  ///< world units from the centre: nothing faded yet
    double fade_end = 2.0;    ///< world units from the centre: all faded; > fade_begin

    /// Distance along a ray to the sheet, if it lies in the ray's interval and is met from above.
    std::optional<double> intersect(const trace::Ray& ray) const;
    /// Share of the backdrop, 0 to 1, in what the camera sees at this point.
    double fade(const glm::dvec3& point) const;
};

}  // namespace stratum::shade
