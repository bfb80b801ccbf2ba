// Fits a diffuse and a glossy lobe to a measured BRDF.
#pragma once

#include "shade/brdf/brdf_scan.h"

#include <array>

namespace stratum::shade {

/// f = kd / pi + ks F(h)/F0 D(h) G2 / (4 cos cos), GGX with alpha and the Fresnel reflectance of eta 1.5.
struct Lobes {
    double kd = 0.0;
    double ks = 0.0;     ///< reflectance of the interface at normal incidence
    double alpha = 0.3;  ///< GGX's, in [0.005, 1]

    /// 1/sr; light and detector unit, z up, both above the surface.
    double eval(const glm::dvec3& light, const glm::dvec3& detector) const;
    /// Of the glossy lobe with ks = 1.
    static double gloss(double alpha, const glm::dvec3& light, const glm::dvec3& detector);
};

/// Per channel, the lobes with the least mean squared log error over all readings of a folded scan.
std::array<Lobes, 3> fitLobes(const BrdfScan& scan);

}  // namespace stratum::shade
