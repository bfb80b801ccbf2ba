// Lamps: light from a place or a direction of its own, beside the environment.
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
    float pdf = 0.0f;   ///< per steradian; 0 for a light without extent, which no other strategy can find
};

/// Where a ray meets a lamp.
struct LightHit {
    double t = std::numeric_limits<double>::infinity();  ///< world units along the ray
    Color radiance{0.0f};
    float pdf = 0.0f;  ///< of sample() in the ray's direction from the ray's origin, per steradian
};

/// A lamp. It gives light; it doesn't stand in the way of any, and the camera doesn't see it. World space.
/// Immutable; shared by all threads.
class Light {
public:
    virtual ~Light() = default;
    /// Nothing if no light comes from here.
    /// @param u  uniform in [0, 1)^2; a light without extent ignores it
    virtual std::optional<LightSample> sample(const glm::dvec3& point, const glm::vec2& u) const = 0;
    /// For lights with extent, so that a BRDF's samples can find them.
    virtual std::optional<LightHit> intersect(const trace::Ray&) const { return std::nullopt; }
    /// Whether sample() draws, i.e. has another answer for another u.
    virtual bool hasExtent() const { return false; }
};

/// A lamp from the text of --light. X,Y,Z are world units; R,G,B linear and not negative:
///   directional:X,Y,Z,R,G,B    parallel light that travels along X,Y,Z; R,G,B is its irradiance
///   sun:X,Y,Z,R,G,B[,DEGREES]  the same with soft shadows: a disc this wide in the sky (default 0.53)
///   point:X,Y,Z,R,G,B          from the place X,Y,Z; R,G,B is its intensity: irradiance times squared distance
///   rectangle:X,Y,Z,UX,UY,UZ,VX,VY,VZ,R,G,B  centre, two perpendicular half edges; shines with radiance R,G,B to
///                              both sides
/// Throws UsageError.
std::shared_ptr<const Light> parseLight(std::string_view text);

/// `ambient:R,G,B`: radiance that reaches every point from everywhere, whatever is in the way. Nothing if the text is
/// another kind of light. Throws UsageError.
std::optional<Color> parseAmbient(std::string_view text);

/// Irradiance of a horizontal surface at this point that looks up, with nothing in the way.
Color irradianceFrom(const Light& light, const glm::dvec3& point);

}  // namespace stratum::shade
