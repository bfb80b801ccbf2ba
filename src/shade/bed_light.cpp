#include "shade/bed_light.h"

#include "shade/sampling.h"

#include <algorithm>

namespace stratum::shade {
namespace {

SphereDistribution tableOf(const Environment& environment) {
    // A share of plain cosine, so that a lamp that slips between the table's probes is drawn, if rarely.
    constexpr double kShare = 0.05;
    const double mean = static_cast<double>(luminance(irradianceFromAbove(environment)) * kInvPi);
    const auto weight = [&](const glm::dvec3& d) {
        return std::max(d.z, 0.0) *
               ((1.0 - kShare) * static_cast<double>(luminance(environment.radiance(glm::vec3(d)))) + kShare * mean);
    };
    return {weight, 256, 128};
}

}  // namespace

TabulatedBedLight::TabulatedBedLight(const Environment& environment)
    : environment_(environment), table_(tableOf(environment)) {}

EnvironmentSample TabulatedBedLight::sample(int, const glm::vec2& u) const {
    EnvironmentSample result;
    result.direction = table_.sample(u, result.pdf);
    if (result.pdf > 0.0f) result.radiance = environment_.radiance(result.direction);
    return result;
}

}  // namespace stratum::shade
