// Environment light from a latitude-longitude map: an HDR photograph or a tabulated sky.
#pragma once

#include "shade/environment/bilinear_distribution.h"
#include "shade/environment/environment.h"
#include "shade/environment/light_map.h"

#include <memory>
#include <span>
#include <vector>

namespace stratum::shade {

/// A latitude-longitude map, interpolated bilinearly. The map's middle column is towards +x and azimuth increases to
/// the left, as in Blender, so that a scene looks the same in both.
///
/// Sampling uses MIS compensation: it samples only where the map is brighter than its mean and leaves the rest to the
/// BRDF's samples. Source: O. Karlik et al., "MIS Compensation: Optimizing Sampling Techniques in Multiple Importance
/// Sampling", SIGGRAPH Asia 2019. makeBedSampler() is unbiased alone. The density also includes the cosine to the
/// normal (see BilinearDistribution). Small bright areas, a sun or lamps, have a strategy of their own.
class MapEnvironment final : public Environment {
public:
    /// @param rotation  radians: turns the light counter-clockwise about +z as seen from above
    /// @param scale     of radiance, > 0
    /// @param visible   see Environment::visible
    /// @param sun       see Environment::sun
    MapEnvironment(LightMap map, double rotation, float scale, bool visible = true,
                   std::shared_ptr<const Light> sun = nullptr);
    int strategies() const override { return static_cast<int>(tables_.size()); }
    bool visible() const override { return visible_; }
    std::shared_ptr<const Light> sun() const override { return sun_; }
    void radianceStream(std::span<const glm::vec3> directions, std::span<Color> radiances) const override;
    void sampleStream(int strategy, std::span<const glm::vec2> u, std::span<const glm::vec3> normals,
                      std::span<EnvironmentSample> samples) const override;
    void evalStream(std::span<const glm::vec3> directions, std::span<const glm::vec3> normals,
                    std::span<EnvironmentSample> samples) const override;
    std::unique_ptr<const EnvironmentSampler> makeBedSampler() const override;
    /// By the map's own texels, so that a sun is never missed: exact to 5e-5.
    Color irradianceFromAbove() const override;

private:
    LightMap map_;
    double rotation_;
    bool visible_;
    std::shared_ptr<const Light> sun_;
    std::vector<BilinearDistribution> tables_;  // one a strategy
};

}  // namespace stratum::shade
