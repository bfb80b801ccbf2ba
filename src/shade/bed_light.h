// The environment as the bed receives it.
#pragma once

#include "shade/distribution.h"
#include "shade/environment.h"

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
    /// Sum of the strategies' densities per steradian.
    virtual float pdf(const glm::vec3& direction) const = 0;
};

/// For light without small details: by a table of probes.
class TabulatedBedLight final : public BedLight {
public:
    explicit TabulatedBedLight(const Environment& environment);
    EnvironmentSample sample(int strategy, const glm::vec2& u) const override;
    float pdf(const glm::vec3& direction) const override { return table_.pdf(direction); }

private:
    const Environment& environment_;
    SphereDistribution table_;
};

}  // namespace stratum::shade
