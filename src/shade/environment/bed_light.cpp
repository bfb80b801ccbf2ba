#include "shade/environment/bed_light.h"

#include "shade/camera/sampling.h"

#include <algorithm>

namespace stratum::shade {

void BedLight::sampleStream(int strategy, std::span<const glm::vec2> u, std::span<EnvironmentSample> samples) const {
    for (std::size_t n = 0; n < u.size(); ++n) samples[n] = sample(strategy, u[n]);
}

void BedLight::evalStream(std::span<const glm::vec3> directions, std::span<EnvironmentSample> samples) const {
    for (std::size_t n = 0; n < directions.size(); ++n) samples[n] = eval(directions[n]);
}

EnvironmentSample CosineBedLight::sample(int, const glm::vec2& u) const { return eval(toCosineHemisphere(u)); }

EnvironmentSample CosineBedLight::eval(const glm::vec3& direction) const {
    return {direction, environment_.radiance(direction), std::max(direction.z, 0.0f) * kInvPi};
}

}  // namespace stratum::shade
