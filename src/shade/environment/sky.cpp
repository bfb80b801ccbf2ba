#include "shade/environment/studio_and_sky.h"

#include "shade/camera/sampling.h"
#include "shade/environment/map_environment.h"
#include "shade/light/light.h"
#include "shade/primaries.h"

#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <numbers>

namespace stratum::shade {
namespace {

/// Perez' five-parameter shape of a sky, for one of Y, x, y.
struct Perez {
    double a, b, c, d, e;
    double operator()(double cos_theta, double gamma) const {
        const double cos_gamma = std::cos(gamma);
        return (1.0 + a * std::exp(b / std::max(cos_theta, 0.01))) *
               (1.0 + c * std::exp(d * gamma) + e * cos_gamma * cos_gamma);
    }
};

struct Model {
    std::array<Perez, 3> shape;      // Y, x, y
    std::array<double, 3> zenith{};  // kcd/m2, chromaticities
    glm::dvec3 sun;

    explicit Model(const SkyOptions& o)
        : sun(std::cos(o.elevation) * std::cos(o.azimuth), std::cos(o.elevation) * std::sin(o.azimuth),
              std::sin(o.elevation)) {
        const double t = o.turbidity;
        shape = {{{0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251, 0.1206 * t - 2.5771,
                   -0.0670 * t + 0.3703},
                  {-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989,
                   -0.0033 * t + 0.0452},
                  {-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102, -0.0441 * t - 1.6537,
                   -0.0109 * t + 0.0529}}};
        const double s = 0.5 * std::numbers::pi - o.elevation;
        const double chi = (4.0 / 9.0 - t / 120.0) * (std::numbers::pi - 2.0 * s);
        const auto cubic = [s](double a, double b, double c, double d) { return ((a * s + b) * s + c) * s + d; };
        zenith = {(4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192,
                  t * t * cubic(0.00166, -0.00375, 0.00209, 0.0) + t * cubic(-0.02903, 0.06377, -0.03202, 0.00394) +
                      cubic(0.11693, -0.21196, 0.06052, 0.25886),
                  t * t * cubic(0.00275, -0.00610, 0.00317, 0.0) + t * cubic(-0.04214, 0.08970, -0.04153, 0.00516) +
                      cubic(0.15346, -0.26756, 0.06670, 0.26688)};
    }

    /// Linear Rec. 709, kcd/m2, for directions above the horizon.
    glm::dvec3 radiance(const glm::dvec3& d) const {
        const double gamma = std::acos(std::clamp(glm::dot(d, sun), -1.0, 1.0));
        const double s = std::acos(std::clamp(sun.z, -1.0, 1.0));
        std::array<double, 3> value{};
        for (std::size_t i = 0; i < 3; ++i) value[i] = zenith[i] * shape[i](d.z, gamma) / shape[i](1.0, s);
        const double y = std::max(value[0], 0.0);
        const double xx = value[1] / value[2] * y;
        const double zz = (1.0 - value[1] - value[2]) / value[2] * y;
        return glm::max(fromXyz(xx, y, zz), glm::dvec3(0.0));
    }

    /// Irradiance on a surface that faces the sun, in units of pi kcd/m2 like radiance() integrates to: klx.
    glm::dvec3 sunlight(double turbidity) const {
        const double elevation = std::asin(sun.z) * 180.0 / std::numbers::pi;
        const double mass = 1.0 / (sun.z + 0.15 * std::pow(elevation + 3.885, -1.253));
        const double beta = 0.04608365822050 * turbidity - 0.04586025928522;
        glm::dvec3 color;
        constexpr std::array<double, 3> kMicrometres = {0.61, 0.55, 0.465};  // of the primaries
        for (int i = 0; i < 3; ++i) {
            const double l = kMicrometres[static_cast<std::size_t>(i)];
            color[i] = std::exp(-mass * (0.008735 * std::pow(l, -4.08) + beta * std::pow(l, -1.3)));
        }
        const double y = 0.2126 * color.r + 0.7152 * color.g + 0.0722 * color.b;
        return color / y * 127.5 * std::exp(-0.21 / sun.z);
    }
};

}  // namespace

std::shared_ptr<const Environment> makeSky(const SkyOptions& options) {
    constexpr int kHeight = 256;
    constexpr double kGround = 0.2;  // reflectance of the land around
    const Model model(options);
    LightMap map{2 * kHeight, kHeight, std::vector<Color>(std::size_t{2} * kHeight * kHeight)};
    glm::dvec3 irradiance(0.0);
    for (int y = 0; y < kHeight / 2; ++y) {
        const double theta = std::numbers::pi * (y + 0.5) / kHeight;
        for (int x = 0; x < map.width; ++x) {
            const double phi = std::numbers::pi - 2.0 * std::numbers::pi * (x + 0.5) / map.width;
            const glm::dvec3 d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
            const glm::dvec3 c = model.radiance(d);
            irradiance += c * (std::sin(theta) * std::cos(theta) * std::numbers::pi / kHeight * 2.0 * std::numbers::pi /
                               map.width);
            map.texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) +
                       static_cast<std::size_t>(x)] = Color(c);
        }
    }
    const glm::dvec3 sun = model.sunlight(options.turbidity);
    const glm::dvec3 total = irradiance + sun * model.sun.z;
    const Color ground(total * kGround / std::numbers::pi);
    for (std::size_t i = map.texels.size() / 2; i < map.texels.size(); ++i) map.texels[i] = ground;
    const float scale = kStudioLevel * kPi / luminance(Color(total));
    return std::make_shared<MapEnvironment>(
        std::move(map), 0.0, scale, true,
        std::make_shared<SunLight>(glm::vec3(model.sun), Color(sun) * scale, SunLight::kRealDiameter));
}

}  // namespace stratum::shade
