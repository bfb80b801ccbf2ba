// The environment as the bed receives it.
#pragma once

#include "shade/distribution.h"
#include "shade/environment.h"

namespace stratum::shade {

/// Draws directions by radiance times the cosine to +z: what a horizontal matt surface scatters. Where nothing is in
/// the way every sample has nearly the same value, so the open bed, most of a picture, is free of noise. Complete on
/// its own (pdf > 0 over the whole upper hemisphere): needs no second strategy. Keeps a reference to the environment.
class BedLight {
public:
    explicit BedLight(const Environment& environment);
    /// @param u  uniform in [0, 1)^2
    EnvironmentSample sample(const glm::vec2& u) const;

private:
    const Environment& environment_;
    SphereDistribution table_;
};

}  // namespace stratum::shade
