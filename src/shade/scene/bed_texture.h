// The material of the bed: plain paper, or printers' build plates.
#pragma once

#include "base/names.h"
#include "shade/brdf/brdf.h"
#include "shade/color.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <memory>
#include <string_view>

namespace stratum::shade {

enum class BedSurface : std::uint8_t {
    paper,  ///< plain, matt and light: a photographer's sweep
    pei,    ///< a powder-coated steel sheet: dark bronze, satin, bumps of about 0.4 mm
    grid,   ///< a dark matt plate with light lines every 10 mm, broader ones every 50
};
inline constexpr Names<BedSurface, 3> kBedSurfaces = {
    {{"paper", BedSurface::paper}, {"pei", BedSurface::pei}, {"grid", BedSurface::grid}}};

/// Throws UsageError.
BedSurface parseBedSurface(std::string_view text);

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

}  // namespace stratum::shade
