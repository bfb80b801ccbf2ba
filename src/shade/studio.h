// A photographer's studio: softboxes in a dim room, arranged about the camera so that layer lines can be read.
#pragma once

#include "shade/distribution.h"
#include "shade/environment.h"

namespace stratum::shade {

/// A large key light high on the left, a broad weak fill on the right, two strips behind that draw the rims, and a room
/// that is brighter above than at the horizon. Edges are smooth. Scaled so that a white Lambert surface that looks up
/// has radiance 1.
class StudioEnvironment final : public Environment {
public:
    explicit StudioEnvironment(const EnvironmentPlacement& placement);
    Color radiance(const glm::vec3& direction) const override;
    EnvironmentSample sample(const glm::vec2& u) const override;
    float pdf(const glm::vec3& direction) const override;
    bool visible() const override { return false; }

private:
    glm::vec3 toStudio(const glm::vec3& world) const;

    float cosine_, sine_;  // of the azimuth
    bool bed_;
    float scale_ = 1.0f;
    SphereDistribution table_;
};

}  // namespace stratum::shade
