// Constant environment light.
#pragma once

#include "shade/environment/environment.h"

namespace stratum::shade {

class ConstantEnvironment final : public Environment {
public:
    /// @param radiance  >= 0
    explicit ConstantEnvironment(const Color& radiance) : radiance_(radiance) {}
    void radianceStream(std::span<const glm::vec3> directions, std::span<Color> radiances) const override;
    void sampleStream(int strategy, std::span<const glm::vec2> u, std::span<const glm::vec3> normals,
                      std::span<EnvironmentSample> samples) const override;
    void evalStream(std::span<const glm::vec3> directions, std::span<const glm::vec3> normals,
                    std::span<EnvironmentSample> samples) const override;

private:
    Color radiance_;
};

}  // namespace stratum::shade
