// Environment light: radiance from infinitely far away, by direction.
#pragma once

#include "shade/color.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <memory>
#include <span>
#include <string_view>

namespace stratum::shade {

class Light;

/// A direction drawn by an EnvironmentSampler.
struct EnvironmentSample {
    glm::vec3 direction{0.0f, 0.0f, 1.0f};  ///< towards the light, unit, world space
    Color radiance{0.0f};                   ///< from there
    float pdf = 0.0f;                       ///< per steradian, the sum of all strategies; 0 means "no sample"
};

/// Draws directions that light comes from. There may be several strategies, e.g. one for the sun and one for the rest
/// of the sky: each is sampled once at every point, and they are combined by the balance heuristic, so that the
/// contribution of a sample is radiance / pdf. Immutable; shared by all threads.
class EnvironmentSampler {
public:
    virtual ~EnvironmentSampler() = default;
    virtual int strategies() const { return 1; }
    /// Draws a direction for each surface. All spans are of one length.
    /// @param strategy  in [0, strategies())
    /// @param u         uniform in [0, 1)^2
    /// @param normals   of the surfaces, world space, unit: directions below a horizon may be left out
    virtual void sampleStream(int strategy, std::span<const glm::vec2> u, std::span<const glm::vec3> normals,
                              std::span<EnvironmentSample> samples) const = 0;
    /// Radiance and density of given directions.
    /// @param directions  away from the scene, unit
    virtual void evalStream(std::span<const glm::vec3> directions, std::span<const glm::vec3> normals,
                            std::span<EnvironmentSample> samples) const = 0;
    /// Streams of one.
    EnvironmentSample sample(int strategy, const glm::vec2& u, const glm::vec3& normal) const;
    EnvironmentSample eval(const glm::vec3& direction, const glm::vec3& normal) const;
};

/// Radiance by direction (see color.h for the unit). World space, z up. Its samples are to be combined with those of a
/// BRDF by multiple importance sampling: a pdf may be 0 where radiance is small, so alone they are biased.
class Environment : public EnvironmentSampler {
public:
    /// @param directions  away from the scene, unit
    /// @param radiances   as many
    virtual void radianceStream(std::span<const glm::vec3> directions, std::span<Color> radiances) const = 0;
    /// A stream of one.
    Color radiance(const glm::vec3& direction) const;
    /// Whether a camera may see it: true for landscapes, false for softboxes.
    virtual bool visible() const { return true; }
    /// For the bed, a horizontal matt surface, whatever the normals: by radiance times the cosine to +z. Without
    /// occlusion all samples have nearly the same value, so the open bed, most of a picture, is nearly free of noise.
    /// Unbiased alone: pdf > 0 wherever light comes from above. The environment must outlive it. By the cosine alone,
    /// which suits an environment that is nearly constant.
    virtual std::unique_ptr<const EnvironmentSampler> makeBedSampler() const;
    /// Irradiance of a horizontal surface that faces up. (relative, times pi) By quadrature, exact to a thousandth
    /// where radiance is smooth.
    virtual Color irradianceFromAbove() const;
    /// A light of this environment that is not in its radiance, because it is too small for a table. Null if there is
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

// Constant environment light.

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

/// Whether the text of --env names a light that needs no file: studio, sky, constant, alone or with numbers. They have
/// priority over files of the same name; such a file is given as ./NAME.
bool isEnvironmentPreset(std::string_view text);

}  // namespace stratum::shade
