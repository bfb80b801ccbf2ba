// A complete BRDF from a scan at a few angles of incidence.
#pragma once

#include "shade/brdf/brdf_scan.h"
#include "shade/brdf/lobe_fit.h"

#include <array>
#include <vector>

namespace stratum::shade {

/// Interpolates between measured incidences, and extrapolates beyond the last one.
///
/// 1. A diffuse and a GGX lobe are fitted per channel to all readings (fitLobes).
/// 2. The residual, log(measured / fitted), varies slowly. At another incidence it is interpolated between the measured
///    neighbours, by a map of the unit disc of projected directions that moves one mirror direction to the other and
///    keeps the rim fixed: linear along each ray from the mirror point to the rim. Beyond the last incidence the last
///    one's residual is used.
/// 3. F(light, detector) and F(detector, light) are blended, with more weight for the one whose incidence is nearer to
///    a measured one, so that the result is reciprocal and still exact at measured incidences. Beyond the last measured
///    incidence the distance counts threefold, because that is extrapolation.
/// Isotropic. Immutable; safe to share between threads.
class ScanInterpolant {
public:
    /// @param scan  folded, checked
    explicit ScanInterpolant(const BrdfScan& scan);

    /// 1/sr, > 0. Both unit, z up; polar angles above 89.9 degrees are clamped to that.
    glm::dvec3 eval(const glm::dvec3& light, const glm::dvec3& detector) const;
    const std::array<Lobes, 3>& lobes() const { return lobes_; }

private:
    /// Logarithm of step 2, by angles: of light and detector to the normal, and between them around it.
    glm::dvec3 oneWay(double incidence, double polar, double azimuth) const;
    /// @param azimuth  in [-pi, pi]
    glm::dvec3 residual(std::size_t incidence, double polar, double azimuth) const;
    double distanceToMeasured(double incidence) const;

    BrdfScan scan_;              // only its angles
    std::vector<double> sines_;  // of its incidences
    std::vector<glm::dvec3> residuals_;
    std::array<Lobes, 3> lobes_;
};

}  // namespace stratum::shade
