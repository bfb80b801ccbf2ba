// Environment light: radiance from infinitely far away, by direction.
#pragma once

#include "shade/color.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <memory>
#include <span>
#include <string_view>

namespace stratum::shade {

class BedLight;
class Light;

/// A direction drawn by Environment::sample.
struct EnvironmentSample {
    glm::vec3 direction{0.0f, 0.0f, 1.0f};  ///< towards the light, unit, world space
    Color radiance{0.0f};                   ///< radiance(direction)
    float pdf = 0.0f;                       ///< pdf(direction, normal), the sum of all strategies; 0 means "no sample"
};

/// Radiance by direction (see color.h for the unit). World space, z up.
///
/// sample() is to be combined with samples of a BRDF by multiple importance sampling: its pdf may be 0 where radiance
/// is small, so alone it is biased. There may be several strategies, e.g. one for the sun and one for the rest of the
/// sky: each is sampled once at every point, and they are combined by the balance heuristic, so that the contribution
/// of a sample is radiance / pdf. Immutable; shared by all threads.
class Environment {
public:
    virtual ~Environment() = default;
    /// @param direction  away from the scene, unit
    virtual Color radiance(const glm::vec3& direction) const = 0;
    virtual int strategies() const { return 1; }
    /// @param strategy  in [0, strategies())
    /// @param u         uniform in [0, 1)^2
    /// @param normal    of the surface, world space, unit: directions below its horizon may be left out
    virtual EnvironmentSample sample(int strategy, const glm::vec2& u, const glm::vec3& normal) const = 0;
    /// Sum of the strategies' densities per steradian, for a surface of that normal.
    virtual float pdf(const glm::vec3& direction, const glm::vec3& normal) const = 0;
    /// radiance and pdf of a direction at once.
    virtual EnvironmentSample eval(const glm::vec3& direction, const glm::vec3& normal) const {
        return {direction, radiance(direction), pdf(direction, normal)};
    }
    /// radiance() of many directions, sample() for many surfaces, and eval(); faster. All spans are of one length.
    virtual void radianceStream(std::span<const glm::vec3> directions, std::span<Color> radiances) const;
    virtual void sampleStream(int strategy, std::span<const glm::vec2> u, std::span<const glm::vec3> normals,
                              std::span<EnvironmentSample> samples) const;
    virtual void evalStream(std::span<const glm::vec3> directions, std::span<const glm::vec3> normals,
                            std::span<EnvironmentSample> samples) const;
    /// Whether a camera may see it: true for landscapes, false for softboxes.
    virtual bool visible() const { return true; }
    /// The sampling of this environment on the bed. The environment must outlive it.
    virtual std::unique_ptr<const BedLight> makeBedLight() const;
    /// A light of this environment that is not in radiance(), because it is too small for a table. Null if there is
    /// none.
    virtual std::shared_ptr<const Light> sun() const { return nullptr; }
};

/// Orientation and exposure of the environment.
struct EnvironmentPlacement {
    double azimuth = 0.0;   ///< radians about +z, from +x: direction of the camera's right-hand side
    bool bed = true;        ///< a bed hides the lower hemisphere, so a studio needs no light from below
    double rotation = 0.0;  ///< --env-rotation, radians: rotates the light counter-clockwise as seen from above
    double exposure = 0.0;  ///< --env-exposure, stops: radiance of a map is scaled by 2^exposure, in [-30, 30]
};

/// An environment from the text of --env.
///   studio            softboxes that rotate with the camera's azimuth, as on a photographer's turntable
///   sky               a clear day, the sun behind the camera's left shoulder
///   sky:ELEVATION,AZIMUTH[,TURBIDITY]  the sun in degrees above the horizon and from +x; haze from 2 to 8
///   constant:R,G,B    the same radiance from everywhere
///   anything else     a .hdr or .exr file, see MapEnvironment
/// Throws UsageError, InputError.
std::shared_ptr<const Environment> makeEnvironment(std::string_view text, const EnvironmentPlacement& placement);

/// Irradiance of a horizontal surface that faces up, by quadrature. (relative, times pi)
Color irradianceFromAbove(const Environment& environment);

}  // namespace stratum::shade
