#include "shade/brdf/brdf.h"

#include "shade/camera/sampling.h"

#include <cmath>

namespace stratum::shade {

void Brdf::evalStream(std::span<const glm::vec3> wo, std::span<const glm::vec3> wi, std::span<Color> values,
                      std::span<float> densities) const {
    for (std::size_t n = 0; n < wo.size(); ++n) {
        values[n] = eval(wo[n], wi[n]);
        densities[n] = pdf(wo[n], wi[n]);
    }
}

void Brdf::sampleStream(std::span<const glm::vec3> wo, std::span<const float> lobes, std::span<const glm::vec2> u,
                        std::span<BrdfSample> samples) const {
    for (std::size_t n = 0; n < wo.size(); ++n) samples[n] = sample(wo[n], lobes[n], u[n]).value_or(BrdfSample());
}

const std::vector<std::string>& Brdf::notes() const {
    static const std::vector<std::string> none;
    return none;
}

Color reflectanceFactor(const Brdf& brdf) {
    const float s = std::sqrt(0.5f);
    return kPi * brdf.eval({0.0f, 0.0f, 1.0f}, {s, 0.0f, s});
}

}  // namespace stratum::shade
