#include "shade/map_environment.h"

#include "shade/bed_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::shade {
namespace {

constexpr double kPiD = std::numbers::pi;

LightMap scaled(LightMap map, float scale) {
    if (scale != 1.0f)
        for (Color& c : map.texels) c *= scale;
    return map;
}

/// Luminance above the mean over the sphere: what is left for the map to draw when the BRDF draws as well.
std::vector<float> compensatedWeights(const LightMap& map) {
    double mean = 0.0;
    double total = 0.0;
    std::vector<float> weights;
    weights.reserve(map.texels.size());
    for (int y = 0; y < map.height; ++y) {
        const double sine = std::sin(kPiD * (y + 0.5) / map.height);
        for (int x = 0; x < map.width; ++x) {
            weights.push_back(luminance(map.at(x, y)));
            mean += sine * static_cast<double>(weights.back());
            total += sine;
        }
    }
    const auto floor = static_cast<float>(mean / total);
    std::vector<float> above = weights;
    for (float& w : above) w = std::max(w - floor, 0.0f);
    // Of a map as even as numbers can be, nothing would be left.
    const bool even = std::all_of(above.begin(), above.end(), [floor](float w) { return w <= 1e-3f * floor; });
    return even ? weights : above;
}

/// Luminance times the cosine to +z.
std::vector<float> cosineWeights(const LightMap& map) {
    std::vector<float> weights;
    weights.reserve(map.texels.size());
    for (int y = 0; y < map.height; ++y) {
        // The largest cosine of the row, so that nothing that shines on the bed has no weight.
        const auto cosine = static_cast<float>(std::max(0.0, std::cos(kPiD * y / map.height)));
        for (int x = 0; x < map.width; ++x) weights.push_back(cosine * luminance(map.at(x, y)));
    }
    return weights;
}

}  // namespace

/// Draws by the map's own texels, so that no sun slips through.
class MapBedLight final : public BedLight {
public:
    explicit MapBedLight(const MapEnvironment& environment)
        : environment_(environment),
          table_(cosineWeights(environment.map_), environment.map_.width, environment.map_.height) {}
    EnvironmentSample sample(const glm::vec2& u) const override { return environment_.draw(table_, u); }
    float pdf(const glm::vec3& direction) const override { return environment_.density(table_, direction); }

private:
    const MapEnvironment& environment_;
    BilinearDistribution table_;
};

MapEnvironment::MapEnvironment(LightMap map, double rotation, float scale)
    : map_(scaled(std::move(map), scale)),
      rotation_(rotation),
      table_(compensatedWeights(map_), map_.width, map_.height) {}

glm::dvec2 MapEnvironment::place(const glm::vec3& direction, double& sine) const {
    const double x = direction.x;
    const double y = direction.y;
    sine = std::sqrt(x * x + y * y);
    double u = 0.5 - (std::atan2(y, x) - rotation_) / (2.0 * kPiD);
    u -= std::floor(u);
    const double v = std::atan2(sine, static_cast<double>(direction.z)) / kPiD;
    return {u < 1.0 ? u : 0.0, v};
}

Color MapEnvironment::lookUp(const glm::dvec2& place) const {
    double sx = place.x * map_.width - 0.5;
    if (sx < 0.0) sx += map_.width;
    const double sy = std::clamp(place.y * map_.height - 0.5, 0.0, map_.height - 1.0);
    const int x0 = std::clamp(static_cast<int>(sx), 0, map_.width - 1);
    const int y0 = std::min(static_cast<int>(sy), map_.height - 1);
    const int x1 = x0 + 1 == map_.width ? 0 : x0 + 1;
    const int y1 = std::min(y0 + 1, map_.height - 1);
    const auto wx = static_cast<float>(sx - x0);
    const auto wy = static_cast<float>(sy - y0);
    return (1.0f - wy) * ((1.0f - wx) * map_.at(x0, y0) + wx * map_.at(x1, y0)) +
           wy * ((1.0f - wx) * map_.at(x0, y1) + wx * map_.at(x1, y1));
}

Color MapEnvironment::radiance(const glm::vec3& direction) const {
    double sine = 0.0;
    return lookUp(place(direction, sine));
}

EnvironmentSample MapEnvironment::draw(const BilinearDistribution& table, const glm::vec2& u) const {
    double density = 0.0;
    const glm::dvec2 p = table.sample(u, density);
    const double theta = kPiD * p.y;
    const double phi = 2.0 * kPiD * (0.5 - p.x) + rotation_;
    const double s = std::sin(theta);
    EnvironmentSample result;
    result.direction = {s * std::cos(phi), s * std::sin(phi), std::cos(theta)};
    if (!(density > 0.0 && s > 0.0)) return result;
    result.pdf = static_cast<float>(density / (2.0 * kPiD * kPiD * s));
    if (!std::isfinite(result.pdf)) result.pdf = 0.0f;
    result.radiance = lookUp(p);
    return result;
}

EnvironmentSample MapEnvironment::sample(const glm::vec2& u) const { return draw(table_, u); }

float MapEnvironment::density(const BilinearDistribution& table, const glm::vec3& direction) const {
    double sine = 0.0;
    const glm::dvec2 p = place(direction, sine);
    if (!(sine > 0.0)) return 0.0f;
    const auto result = static_cast<float>(table.pdf(p) / (2.0 * kPiD * kPiD * sine));
    return std::isfinite(result) ? result : 0.0f;
}

float MapEnvironment::pdf(const glm::vec3& direction) const { return density(table_, direction); }

std::unique_ptr<const BedLight> MapEnvironment::makeBedLight() const { return std::make_unique<MapBedLight>(*this); }

}  // namespace stratum::shade
