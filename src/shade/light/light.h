// Lights beside the environment: directional, point, area.
#pragma once

#include "shade/color.h"
#include "trace/intersector.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <limits>
#include <memory>
#include <optional>
#include <string_view>

namespace stratum::shade {

/// Light that a point receives from one direction.
struct LightSample {
    glm::vec3 direction{0.0f, 0.0f, 1.0f};                      ///< towards the light, unit, world space
    double distance = std::numeric_limits<double>::infinity();  ///< to the light, world units
    Color light{0.0f};  ///< radiance if pdf > 0; for a light without extent the irradiance on a surface that faces it
    float pdf = 0.0f;   ///< per steradian; 0 for a light without extent (a delta light)
};

/// Intersection of a ray with a light.
struct LightHit {
    double t = std::numeric_limits<double>::infinity();  ///< world units along the ray
    Color radiance{0.0f};
    float pdf = 0.0f;  ///< pdf of sample() at the ray's origin for the ray's direction, per steradian
};

/// A light. It occludes nothing and is invisible to the camera. World space. Immutable; shared by all threads.
class Light {
public:
    virtual ~Light() = default;
    /// Nothing if the point receives no light from it.
    /// @param u  uniform in [0, 1)^2; a light without extent ignores it
    virtual std::optional<LightSample> sample(const glm::dvec3& point, const glm::vec2& u) const = 0;
    /// For lights with extent: where a ray drawn from a BRDF hits it.
    virtual std::optional<LightHit> intersect(const trace::Ray&) const { return std::nullopt; }
    /// Whether sample() depends on u.
    virtual bool hasExtent() const { return false; }
};

/// A light from the text of --light. X,Y,Z are world units; R,G,B linear and not negative:
///   directional:X,Y,Z,R,G,B    parallel light that travels along X,Y,Z; R,G,B is its irradiance
///   sun:X,Y,Z,R,G,B[,DEGREES]  the same with soft shadows: a disc this wide in the sky (default 0.53)
///   point:X,Y,Z,R,G,B          from the position X,Y,Z; R,G,B is its intensity: irradiance times squared distance
///   rectangle:X,Y,Z,UX,UY,UZ,VX,VY,VZ,R,G,B  center, two perpendicular half edges; shines with radiance R,G,B to
///                              both sides
/// Throws UsageError.
std::shared_ptr<const Light> parseLight(std::string_view text);

/// `ambient:R,G,B`: radiance that reaches every point from all directions, without occlusion. Nothing if the text is
/// another kind of light. Throws UsageError.
std::optional<Color> parseAmbient(std::string_view text);

/// Unoccluded irradiance of a horizontal surface that faces up at this point.
/// @param side  of a light with extent: side * side places on it are used
Color irradianceFrom(const Light& light, const glm::dvec3& point, int side = 32);

// Lights at infinity: one direction, or a disc in the sky.

/// One direction, hard shadows. A white Lambert surface that faces it gets radiance irradiance / pi.
class DirectionalLight final : public Light {
public:
    /// @param to_light    towards the light, unit, world space
    /// @param irradiance  on a surface that faces the light
    DirectionalLight(const glm::vec3& to_light, const Color& irradiance)
        : to_light_(to_light), irradiance_(irradiance) {}
    std::optional<LightSample> sample(const glm::dvec3& point, const glm::vec2& u) const override;

private:
    glm::vec3 to_light_;
    Color irradiance_;
};

/// A disc of constant radiance in the sky: soft shadows, and highlights with a size.
class SunLight final : public Light {
public:
    static constexpr float kRealDiameter = 0.53f;  ///< degrees

    /// @param to_light    towards the middle, unit, world space
    /// @param irradiance  on a surface that faces it
    /// @param diameter    degrees, above 0 and at most 90
    SunLight(const glm::vec3& to_light, const Color& irradiance, float diameter);
    std::optional<LightSample> sample(const glm::dvec3& point, const glm::vec2& u) const override;
    std::optional<LightHit> intersect(const trace::Ray& ray) const override;
    bool hasExtent() const override { return true; }

private:
    glm::vec3 to_light_;
    Color radiance_;
    double lift_;  // 1 - cosine of the half angle; stored itself, because a float's 1 - cos would lose digits
    float pdf_;
};

// A point light.

/// The same intensity in all directions, hard shadows; irradiance falls with the squared distance.
class PointLight final : public Light {
public:
    /// @param intensity  irradiance times squared distance (world units)
    PointLight(const glm::dvec3& position, const Color& intensity) : position_(position), intensity_(intensity) {}
    std::optional<LightSample> sample(const glm::dvec3& point, const glm::vec2& u) const override;

private:
    glm::dvec3 position_;
    Color intensity_;
};

// A rectangular area light: a softbox, a window, a screen.

/// A rectangle of constant radiance that emits to both sides. Sampled by solid angle:
/// C. Urena, M. Fajardo, A. King, "An Area-Preserving Parametrization for Spherical Rectangles", EGSR 2013.
class RectangleLight final : public Light {
public:
    /// @param half_u, half_v  perpendicular. World units
    RectangleLight(const glm::dvec3& center, const glm::dvec3& half_u, const glm::dvec3& half_v, const Color& radiance);
    std::optional<LightSample> sample(const glm::dvec3& point, const glm::vec2& u) const override;
    std::optional<LightHit> intersect(const trace::Ray& ray) const override;
    bool hasExtent() const override { return true; }

private:
    struct View;
    View viewFrom(const glm::dvec3& point) const;

    glm::dvec3 center_, x_, y_, z_;  // unit axes; z is across
    double half_x_, half_y_;         // world units
    Color radiance_;
};

}  // namespace stratum::shade
