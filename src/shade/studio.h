// A photographer's studio: softboxes in a dim room, arranged about the camera so that layer lines can be read.
#pragma once

#include "shade/distribution.h"
#include "shade/environment.h"

namespace stratum::shade {

/// A key light high on the left, a broad weak fill on the right, two strips behind that draw the rims, and a room that
/// is brighter above than at the horizon. Edges are smooth.
class StudioEnvironment final : public Environment {
public:
    /// Radiance of a white Lambert surface that looks up, with nothing in its way. Bright enough that a print and the
    /// paper under it need no exposure.
    static constexpr float kLevel = 1.5f;

    explicit StudioEnvironment(const EnvironmentPlacement& placement);
    Color radiance(const glm::vec3& direction) const override;
    EnvironmentSample sample(int strategy, const glm::vec2& u, const glm::vec3& normal) const override;
    float pdf(const glm::vec3& direction, const glm::vec3& normal) const override;
    bool visible() const override { return false; }

private:
    glm::vec3 toStudio(const glm::vec3& world) const;

    float cosine_, sine_;  // of the azimuth
    bool bed_;
    float scale_ = 1.0f;
    SphereDistribution table_;
};

}  // namespace stratum::shade
