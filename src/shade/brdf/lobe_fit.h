// Fits a diffuse and a glossy lobe to a measured BRDF.
#pragma once

#include "shade/brdf/brdf_scan.h"

#include <glm/geometric.hpp>

#include <array>

namespace stratum::shade {

/// What the glossy lobes of a pair of directions have in common. Light and detector are unit, z up.
class GlossyPair {
public:
    GlossyPair(const glm::dvec3& light, const glm::dvec3& detector)
        : GlossyPair(light, detector, glm::normalize(light + detector)) {}
    /// Of a GGX lobe with this alpha and a reflectance of 1 at normal incidence, 1/sr.
    double gloss(double alpha) const;

private:
    GlossyPair(const glm::dvec3& light, const glm::dvec3& detector, const glm::dvec3& half);

    struct Slope {
        explicit Slope(const glm::dvec3& d) : cosine(d.z), sine2(d.x * d.x + d.y * d.y) {}
        double cosine, sine2;  // of the angle to the normal, and the square of its sine
    };
    Slope light_, detector_, half_;
    double fresnel_;  // over that at normal incidence
};

/// f = kd / pi + ks F(h)/F0 D(h) G2 / (4 cos cos), GGX with alpha and the Fresnel reflectance of eta 1.5.
struct Lobes {
    double kd = 0.0;
    double ks = 0.0;     ///< reflectance of the interface at normal incidence
    double alpha = 0.3;  ///< GGX's, in [0.005, 1]

    /// 1/sr; both directions above the surface.
    double eval(const GlossyPair& pair) const;
};

/// Per channel, the lobes with the least mean squared log error over all readings of a folded scan. On all threads.
std::array<Lobes, 3> fitLobes(const BrdfScan& scan);

}  // namespace stratum::shade
