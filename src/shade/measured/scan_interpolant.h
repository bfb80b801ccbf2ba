// A whole BRDF from a scan at a few angles of incidence.
#pragma once

#include "shade/brdf/brdf_scan.h"
#include "shade/brdf/lobe_fit.h"

#include <array>

namespace stratum::shade {

/// Between measured incidences, and past the last one.
///
/// 1. A diffuse and a GGX lobe are fitted per channel to all readings (fitLobes).
/// 2. What they leave, log(measured / fitted), varies slowly. At another incidence it is taken from the measured
///    neighbours, in a map of the unit disc of projected directions that carries the one mirror direction to the other
///    and leaves the rim in place: along the straight ray from the mirror point to the rim. Past the last incidence the
///    last one's is taken.
/// 3. F(light, detector) and F(detector, light) are both such answers. They are blended, each weighted to the side
/// whose
///    incidence is nearer to a measured one, so that the result is reciprocal and still exact at measured incidences.
///    Beyond the last measured incidence distance counts threefold: there nothing holds the answer on the far side.
/// Isotropic. Immutable; safe to share between threads.
class ScanInterpolant {
public:
    /// @param scan  folded, checked
    explicit ScanInterpolant(const BrdfScan& scan);

    /// 1/sr, > 0. Both unit, z up; directions below 89.9 degrees are taken as that.
    glm::dvec3 eval(const glm::dvec3& light, const glm::dvec3& detector) const;
    const std::array<Lobes, 3>& lobes() const { return lobes_; }

private:
    /// Logarithm of step 2, by angles: of light and detector to the normal, and between them around it.
    glm::dvec3 oneWay(double incidence, double polar, double azimuth) const;
    glm::dvec3 residual(std::size_t incidence, double polar, double azimuth) const;
    double distanceToMeasured(double incidence) const;

    BrdfScan scan_;  // only its angles
    std::vector<glm::dvec3> residuals_;
    std::array<Lobes, 3> lobes_;
};

}  // namespace stratum::shade
