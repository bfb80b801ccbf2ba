// The bed under the print and the backdrop behind it: a seamless sweep as in product photography.
#pragma once

#include "base/names.h"
#include "shade/brdf/brdf.h"
#include "shade/color.h"
#include "trace/intersector.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>

namespace stratum::shade {

// The material of the bed: plain paper, or printers' build plates.

enum class BedSurface : std::uint8_t {
    paper,  ///< plain, matt and light: a photographer's sweep
    pei,    ///< a powder-coated steel sheet: dark bronze, satin, bumps of about 0.4 mm
    grid,   ///< a dark matt plate with light lines every 10 mm, broader ones every 50
};
inline constexpr Names<BedSurface, 3> kBedSurfaces = {
    {{"paper", BedSurface::paper}, {"pei", BedSurface::pei}, {"grid", BedSurface::grid}}};

/// Procedural reflectance and normal by position, unbounded. Immutable.
class BedTexture {
public:
    struct Finish {
        std::shared_ptr<const Brdf> brdf;
        Color albedo{0.0f};  ///< reflectanceFactor of brdf
    };

    /// @param mm_per_unit  millimetres a world unit
    explicit BedTexture(BedSurface surface, double mm_per_unit = 1.0);
    /// Paper of that reflectance, in [0, 1].
    explicit BedTexture(const Color& paper);

    /// @param place  world units
    const Finish& at(const glm::dvec2& place) const;
    /// Whether normal() differs from straight up anywhere.
    bool bumpy() const { return surface_ == BedSurface::pei; }
    /// The shading normal, unit, upwards.
    /// @param place  world units
    glm::dvec3 normal(const glm::dvec2& place) const;
    /// Mean reflectance over a large area.
    const Color& mean() const { return mean_; }

private:
    BedSurface surface_;
    double mm_per_unit_ = 1.0;
    Finish base_, lines_;  // the second of the grid only
    Color mean_{0.0f};
};

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
    std::optional<double> intersect(const trace::Ray& ray) const {
        const double t = distanceAlong(ray);
        return meets(ray, t) ? std::optional(t) : std::nullopt;
    }
    /// Whether there is such a distance.
    bool blocks(const trace::Ray& ray) const { return meets(ray, distanceAlong(ray)); }
    /// Share of the backdrop, 0 to 1, in what the camera sees at this point.
    double fade(const glm::dvec3& point) const {
        const double dx = point.x - center.x;
        const double dy = point.y - center.y;
        const double square = dx * dx + dy * dy;
        // Most points are on this side of the fade or beyond it.
        if (square <= fade_begin * fade_begin) return 0.0;
        return square >= fade_end * fade_end ? 1.0 : fadeAt(std::sqrt(square));
    }

private:
    double fadeAt(double radius) const;
    // Of a horizontal ray infinite or NaN. Without branches, and here to be inlined: every ray of a picture asks.
    double distanceAlong(const trace::Ray& ray) const { return (z - ray.origin.z) / ray.direction.z; }
    static bool meets(const trace::Ray& ray, double t) {
        return (ray.direction.z < 0.0) & (t >= ray.t_min) & (t <= ray.t_max);
    }
};

}  // namespace stratum::shade
