#include "shade/environment/constant.h"

#include "shade/camera/sampling.h"

#include <algorithm>

namespace stratum::shade {
namespace {

constexpr float kDensity = 0.25f * kInvPi;  // of the whole sphere

}  // namespace

void ConstantEnvironment::radianceStream(std::span<const glm::vec3>, std::span<Color> radiances) const {
    std::fill(radiances.begin(), radiances.end(), radiance_);
}

void ConstantEnvironment::sampleStream(int, std::span<const glm::vec2> u, std::span<const glm::vec3>,
                                       std::span<EnvironmentSample> samples) const {
    for (std::size_t n = 0; n < u.size(); ++n) samples[n] = {toSphere(u[n]), radiance_, kDensity};
}

void ConstantEnvironment::evalStream(std::span<const glm::vec3> directions, std::span<const glm::vec3>,
                                     std::span<EnvironmentSample> samples) const {
    for (std::size_t n = 0; n < directions.size(); ++n) samples[n] = {directions[n], radiance_, kDensity};
}

}  // namespace stratum::shade
