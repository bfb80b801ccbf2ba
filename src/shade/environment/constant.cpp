#include "shade/environment/constant.h"

#include "shade/camera/sampling.h"

namespace stratum::shade {

EnvironmentSample ConstantEnvironment::sample(int, const glm::vec2& u, const glm::vec3&) const {
    return {toSphere(u), radiance_, 0.25f * kInvPi};
}

float ConstantEnvironment::pdf(const glm::vec3&, const glm::vec3&) const { return 0.25f * kInvPi; }

}  // namespace stratum::shade
