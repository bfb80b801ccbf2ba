// The environment as the bed receives it.
#pragma once

#include "shade/environment/environment.h"

#include <span>

namespace stratum::shade {

/// Draws directions by radiance times the cosine to +z: what a horizontal matt surface scatters. Where nothing is in
/// the way every sample has nearly the same value, so the open bed, most of a picture, is nearly free of noise.
/// Complete on its own: pdf > 0 wherever light comes from above. Keeps a reference to the environment.
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

/// For light that is much the same from everywhere: by the cosine alone.
class CosineBedLight final : public BedLight {
public:
    explicit CosineBedLight(const Environment& environment) : environment_(environment) {}
    EnvironmentSample sample(int strategy, const glm::vec2& u) const override;
    EnvironmentSample eval(const glm::vec3& direction) const override;

private:
    const Environment& environment_;
};

}  // namespace stratum::shade
