// Importance sampling of an environment on the bed.
#pragma once

#include "shade/environment/environment.h"

#include <span>

namespace stratum::shade {

/// Samples directions by radiance times the cosine to +z, for a horizontal matt surface. Without occlusion all samples
/// have nearly the same value, so the unoccluded bed, most of a picture, is nearly free of noise. Unbiased on its own:
/// pdf > 0 wherever light comes from above. Keeps a reference to the environment.
class BedLight {
public:
    virtual ~BedLight() = default;
    /// Strategies are as those of an Environment.
    virtual int strategies() const { return 1; }
    /// @param strategy  in [0, strategies())
    /// @param u         uniform in [0, 1)^2
    virtual EnvironmentSample sample(int strategy, const glm::vec2& u) const = 0;
    /// Radiance of the environment, and the sum of the strategies' densities per steradian.
    virtual EnvironmentSample eval(const glm::vec3& direction) const = 0;
    /// sample() of many draws, and eval(); faster. All spans are of one length.
    virtual void sampleStream(int strategy, std::span<const glm::vec2> u, std::span<EnvironmentSample> samples) const;
    virtual void evalStream(std::span<const glm::vec3> directions, std::span<EnvironmentSample> samples) const;
};

/// By the cosine alone, for nearly constant environments.
class CosineBedLight final : public BedLight {
public:
    explicit CosineBedLight(const Environment& environment) : environment_(environment) {}
    EnvironmentSample sample(int strategy, const glm::vec2& u) const override;
    EnvironmentSample eval(const glm::vec3& direction) const override;

private:
    const Environment& environment_;
};

}  // namespace stratum::shade
