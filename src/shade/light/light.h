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

}  // namespace stratum::shade
