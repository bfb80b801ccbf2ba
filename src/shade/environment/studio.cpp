#include "shade/environment/studio_and_sky.h"

#include "shade/camera/sampling.h"
#include "shade/environment/map_environment.h"

#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <numbers>

namespace stratum::shade {
namespace {

/// A lamp seen through a smooth rectangular window. Studio frame: x to the camera's right, y away from the camera, z
/// up.
struct Softbox {
    glm::vec3 direction;  // from the print to its middle, unit
    glm::vec3 across;     // horizontal, unit
    glm::vec3 along;      // unit
    float half_width;     // tangent of the half angle across
    float half_height;    // tangent of the half angle along
    float softness;       // width of the edge, in tangents
    Color radiance;       // of the middle, before scaling

    Softbox(float azimuth, float elevation, float width, float height, float soft, const Color& light)
        : half_width(std::tan(0.5f * radians(width))),
          half_height(std::tan(0.5f * radians(height))),
          softness(soft),
          radiance(light) {
        const float a = radians(azimuth);
        const float e = radians(elevation);
        direction = {std::sin(a) * std::cos(e), std::cos(a) * std::cos(e), std::sin(e)};
        across = {std::cos(a), -std::sin(a), 0.0f};
        along = glm::cross(across, direction);
    }
    static float radians(float degrees) { return degrees * kPi / 180.0f; }
    static float window(float x, float half, float soft) {
        const float t = std::clamp((half + 0.5f * soft - std::abs(x)) / soft, 0.0f, 1.0f);
        return t * t * (3.0f - 2.0f * t);
    }
    Color operator()(const glm::vec3& d) const {
        const float facing = glm::dot(d, direction);
        if (!(facing > 0.05f)) return Color(0.0f);
        return radiance * (window(glm::dot(d, across) / facing, half_width, softness) *
                           window(glm::dot(d, along) / facing, half_height, softness));
    }
};

/// Azimuth is clockwise from "away from the camera": -90 is left, 90 right, 180 the camera. All angles in degrees.
const std::array<Softbox, 4>& softboxes() {
    static const std::array<Softbox, 4> boxes = {
        Softbox(-116.0f, 47.0f, 34.0f, 38.0f, 0.20f, Color(15.0f, 14.7f, 14.2f)),  // key
        Softbox(118.0f, 24.0f, 56.0f, 44.0f, 0.50f, Color(1.00f, 1.05f, 1.13f)),   // fill
        Softbox(52.0f, 32.0f, 18.0f, 60.0f, 0.15f, Color(7.0f, 7.2f, 7.6f)),       // rim, right
        Softbox(-42.0f, 36.0f, 18.0f, 50.0f, 0.15f, Color(6.0f, 6.1f, 6.4f)),      // rim, left
    };
    return boxes;
}

/// @param d  studio frame
Color unscaled(const glm::vec3& d, bool bed) {
    // Without a bed, weaker mirror images of the lights replace its reflection, so that views from below are lit as
    // well.
    if (d.z < 0.0f) return bed ? Color(0.0f) : 0.5f * unscaled({d.x, d.y, -d.z}, bed);
    Color sum = Color(0.16f, 0.17f, 0.19f) + Color(0.20f, 0.20f, 0.19f) * d.z;
    for (const Softbox& box : softboxes()) sum += box(d);
    return sum;
}

// The narrowest edge of a lamp is some 8 degrees wide: six texels.
constexpr int kHeight = 128;

}  // namespace

std::shared_ptr<const Environment> makeStudio(const EnvironmentPlacement& placement) {
    LightMap map{2 * kHeight, kHeight, {}};
    map.texels.reserve(std::size_t{2} * kHeight * kHeight);
    glm::dvec3 irradiance(0.0);
    for (int y = 0; y < map.height; ++y) {
        const double theta = std::numbers::pi * (y + 0.5) / map.height;
        for (int x = 0; x < map.width; ++x) {
            const double phi = std::numbers::pi - 2.0 * std::numbers::pi * (x + 0.5) / map.width;
            const glm::vec3 d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
            map.texels.push_back(unscaled(d, placement.bed));
            if (d.z > 0.0f)
                irradiance += glm::dvec3(map.texels.back()) * (std::sin(theta) * std::cos(theta) * std::numbers::pi /
                                                               map.height * 2.0 * std::numbers::pi / map.width);
        }
    }
    const float scale = kStudioLevel * kPi / luminance(Color(irradiance));
    return std::make_shared<MapEnvironment>(std::move(map), placement.azimuth, scale, false);
}

}  // namespace stratum::shade
