// Environment light from a latitude-longitude map: an HDR photograph or a tabulated sky.
#pragma once

#include "shade/environment/bilinear_distribution.h"
#include "shade/environment/environment.h"
#include "shade/environment/light_map.h"

namespace stratum::shade {

/// A latitude-longitude map, interpolated bilinearly. The map's middle column is towards +x and azimuth increases to
/// the left, as in Blender, so that a scene looks the same in both.
///
/// sample() uses MIS compensation: it samples only where the map is brighter than its mean and leaves the rest to the
/// BRDF's samples. Source: O. Karlik et al., "MIS Compensation: Optimizing Sampling Techniques in Multiple Importance
/// Sampling", SIGGRAPH Asia 2019. makeBedLight() is unbiased on its own. The density also includes the cosine to the
/// normal (see BilinearDistribution). Small bright areas, a sun or lamps, have a strategy of their own.
class MapEnvironment final : public Environment {
public:
    /// @param rotation  radians: turns the light counter-clockwise about +z as seen from above
    /// @param scale     of radiance, > 0
    /// @param visible   see Environment::visible
    /// @param sun       see Environment::sun
    MapEnvironment(LightMap map, double rotation, float scale, bool visible = true,
                   std::shared_ptr<const Light> sun = nullptr);
    Color radiance(const glm::vec3& direction) const override;
    int strategies() const override { return static_cast<int>(tables_.size()); }
    EnvironmentSample sample(int strategy, const glm::vec2& u, const glm::vec3& normal) const override;
    float pdf(const glm::vec3& direction, const glm::vec3& normal) const override;
    EnvironmentSample eval(const glm::vec3& direction, const glm::vec3& normal) const override;
    bool visible() const override { return visible_; }
    std::shared_ptr<const Light> sun() const override { return sun_; }
    void radianceStream(std::span<const glm::vec3> directions, std::span<Color> radiances) const override;
    void sampleStream(int strategy, std::span<const glm::vec2> u, std::span<const glm::vec3> normals,
                      std::span<EnvironmentSample> samples) const override;
    void evalStream(std::span<const glm::vec3> directions, std::span<const glm::vec3> normals,
                    std::span<EnvironmentSample> samples) const override;
    std::unique_ptr<const BedLight> makeBedLight() const override;

private:
    friend class MapBedLight;
    /// Position in the map, [0, 1)^2, and the sine of the polar angle.
    glm::dvec2 uvOf(const glm::vec3& direction, double& sine) const;
    Color lookUp(const glm::dvec2& uv) const;
    using Tables = std::vector<BilinearDistribution>;  // one a strategy
    EnvironmentSample evalTables(const Tables& tables, const glm::vec3& direction, const glm::vec3& normal) const;
    EnvironmentSample sampleTables(const Tables& tables, int strategy, const glm::vec2& u,
                                   const glm::vec3& normal) const;
    /// Per steradian.
    float density(const Tables& tables, const glm::dvec2& uv, double sine, const glm::vec3& normal) const;

    LightMap map_;
    double rotation_;
    bool visible_;
    std::shared_ptr<const Light> sun_;
    Tables tables_;
};

}  // namespace stratum::shade
