#include "shade/environment/map_environment.h"

#include "shade/environment/bed_light.h"
#include "shade/environment/map_stream.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::shade {
namespace {

LightMap scaled(LightMap map, float scale) {
    if (scale != 1.0f)
        for (Color& c : map.texels) c *= scale;
    return map;
}

double sineOf(int row, int height) { return std::sin(std::numbers::pi * (row + 0.5) / height); }

/// Luminance of the texels.
std::vector<float> luminances(const LightMap& map) {
    std::vector<float> weights;
    weights.reserve(map.texels.size());
    for (const Color& c : map.texels) weights.push_back(luminance(c));
    return weights;
}

/// Mean over the sphere.
double meanOf(const std::vector<float>& weights, int width, int height) {
    double sum = 0.0;
    double total = 0.0;
    for (int y = 0; y < height; ++y) {
        const double sine = sineOf(y, height);
        const auto row = static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
        for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x)
            sum += sine * static_cast<double>(weights[row + x]);
        total += sine * width;
    }
    return sum / total;
}

/// Splits weights into those of texels much brighter than the mean and those of the others, if the first ones have a
/// large enough share for a ray of their own; else all are "others". A sun has about half of a clear sky's light.
struct Split {
    std::vector<float> lamps, others;  // lamps is empty if there are none
};
Split splitOf(std::vector<float> weights, int width, int height) {
    constexpr double kBright = 32.0;
    constexpr double kWorthwhile = 0.125;
    const double mean = meanOf(weights, width, height);
    Split split{std::vector<float>(weights.size(), 0.0f), std::move(weights)};
    for (std::size_t n = 0; n < split.others.size(); ++n)
        if (static_cast<double>(split.others[n]) > kBright * mean) std::swap(split.lamps[n], split.others[n]);
    const double share = meanOf(split.lamps, width, height) / mean;
    if (!(share > kWorthwhile && share < 1.0)) {
        for (std::size_t n = 0; n < split.others.size(); ++n) split.others[n] += split.lamps[n];
        split.lamps.clear();
    }
    return split;
}

/// The weights above the mean: MIS compensation, see MapEnvironment.
std::vector<float> compensated(std::vector<float> weights, int width, int height) {
    const auto floor = static_cast<float>(meanOf(weights, width, height));
    // A constant map would have no weight left.
    if (std::all_of(weights.begin(), weights.end(), [floor](float w) { return w <= 1.001f * floor; })) return weights;
    for (float& w : weights) w = std::max(w - floor, 0.0f);
    return weights;
}

/// @param direction  of positions on the map, to include the cosine in the density of the "others". A sun is sampled as
///                   a whole, because it may be just above the horizon of some normals of a bin.
std::vector<BilinearDistribution> tablesOf(Split split, int width, int height,
                                           const BilinearDistribution::Direction& direction = {}) {
    std::vector<BilinearDistribution> tables;
    tables.emplace_back(std::move(split.others), width, height, direction);
    if (!split.lamps.empty()) tables.emplace_back(std::move(split.lamps), width, height);
    return tables;
}

/// The direction of a position on the map. `sine` is that of the polar angle.
glm::vec3 directionOf(const glm::dvec2& uv, double rotation, double& sine) {
    const double theta = std::numbers::pi * uv.y;
    const double phi = 2.0 * std::numbers::pi * (0.5 - uv.x) + rotation;
    sine = std::sin(theta);
    return {sine * std::cos(phi), sine * std::sin(phi), std::cos(theta)};
}

/// For sampling combined with a BRDF.
std::vector<BilinearDistribution> compensatedTables(const LightMap& map, double rotation) {
    Split split = splitOf(luminances(map), map.width, map.height);
    split.others = compensated(std::move(split.others), map.width, map.height);
    return tablesOf(std::move(split), map.width, map.height, [rotation](const glm::dvec2& uv) {
        double sine = 0.0;
        return directionOf(uv, rotation, sine);
    });
}

/// For sampling alone, on a surface that faces up: luminance times the cosine to +z.
std::vector<BilinearDistribution> cosineTables(const LightMap& map) {
    std::vector<float> weights = luminances(map);
    for (int y = 0; y < map.height; ++y) {
        // The largest cosine of the row, so that every direction above the horizon has a weight.
        const auto cosine = static_cast<float>(std::max(0.0, std::cos(std::numbers::pi * y / map.height)));
        const auto row = static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width);
        for (std::size_t x = 0; x < static_cast<std::size_t>(map.width); ++x) weights[row + x] *= cosine;
    }
    return tablesOf(splitOf(std::move(weights), map.width, map.height), map.width, map.height);
}

}  // namespace

/// Samples by the map's own texels, so that a sun is never missed.
class MapBedLight final : public BedLight {
public:
    explicit MapBedLight(const MapEnvironment& environment)
        : environment_(environment), tables_(cosineTables(environment.map_)) {}
    int strategies() const override { return static_cast<int>(tables_.size()); }
    EnvironmentSample sample(int strategy, const glm::vec2& u) const override {
        return environment_.sampleTables(tables_, strategy, u, kUp);
    }
    EnvironmentSample eval(const glm::vec3& direction) const override {
        return environment_.evalTables(tables_, direction, kUp);
    }
    void sampleStream(int strategy, std::span<const glm::vec2> u, std::span<EnvironmentSample> samples) const override {
        sampleMap({environment_.map_, environment_.rotation_, tables_}, strategy, u, {}, samples);
    }
    void evalStream(std::span<const glm::vec3> directions, std::span<EnvironmentSample> samples) const override {
        evalMap({environment_.map_, environment_.rotation_, tables_}, directions, {}, samples);
    }

private:
    static constexpr glm::vec3 kUp{0.0f, 0.0f, 1.0f};
    const MapEnvironment& environment_;
    MapEnvironment::Tables tables_;
};

MapEnvironment::MapEnvironment(LightMap map, double rotation, float scale, bool visible,
                               std::shared_ptr<const Light> sun)
    : map_(scaled(std::move(map), scale)),
      rotation_(rotation),
      visible_(visible),
      sun_(std::move(sun)),
      tables_(compensatedTables(map_, rotation_)) {}

glm::dvec2 MapEnvironment::uvOf(const glm::vec3& direction, double& sine) const {
    const double x = direction.x;
    const double y = direction.y;
    sine = std::sqrt(x * x + y * y);
    double u = 0.5 - (std::atan2(y, x) - rotation_) / (2.0 * std::numbers::pi);
    u -= std::floor(u);
    const double v = std::atan2(sine, static_cast<double>(direction.z)) / std::numbers::pi;
    return {u < 1.0 ? u : 0.0, v};
}

Color MapEnvironment::lookUp(const glm::dvec2& uv) const {
    double sx = uv.x * map_.width - 0.5;
    if (sx < 0.0) sx += map_.width;
    const double sy = std::clamp(uv.y * map_.height - 0.5, 0.0, map_.height - 1.0);
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
    return lookUp(uvOf(direction, sine));
}

EnvironmentSample MapEnvironment::sampleTables(const Tables& tables, int strategy, const glm::vec2& u,
                                               const glm::vec3& normal) const {
    const auto chosen = static_cast<std::size_t>(strategy);
    double density = 0.0;
    const glm::dvec2 uv = tables[chosen].sample(tables[chosen].bin(normal), u, density);
    EnvironmentSample result;
    if (!(density > 0.0)) return result;
    double sine = 0.0;
    result.direction = directionOf(uv, rotation_, sine);
    if (!(sine > 0.0)) return result;
    for (std::size_t k = 0; k < tables.size(); ++k)
        if (k != chosen) density += tables[k].pdf(tables[k].bin(normal), uv);
    result.pdf = static_cast<float>(density / (2.0 * std::numbers::pi * std::numbers::pi * sine));
    if (!std::isfinite(result.pdf)) result.pdf = 0.0f;
    result.radiance = lookUp(uv);
    return result;
}

EnvironmentSample MapEnvironment::sample(int strategy, const glm::vec2& u, const glm::vec3& normal) const {
    return sampleTables(tables_, strategy, u, normal);
}

float MapEnvironment::density(const Tables& tables, const glm::dvec2& uv, double sine, const glm::vec3& normal) const {
    if (!(sine > 0.0)) return 0.0f;
    double density = 0.0;
    for (const BilinearDistribution& table : tables) density += table.pdf(table.bin(normal), uv);
    const auto result = static_cast<float>(density / (2.0 * std::numbers::pi * std::numbers::pi * sine));
    return std::isfinite(result) ? result : 0.0f;
}

float MapEnvironment::pdf(const glm::vec3& direction, const glm::vec3& normal) const {
    double sine = 0.0;
    const glm::dvec2 uv = uvOf(direction, sine);
    return density(tables_, uv, sine, normal);
}

EnvironmentSample MapEnvironment::evalTables(const Tables& tables, const glm::vec3& direction,
                                             const glm::vec3& normal) const {
    double sine = 0.0;
    const glm::dvec2 uv = uvOf(direction, sine);
    return {direction, lookUp(uv), density(tables, uv, sine, normal)};
}

EnvironmentSample MapEnvironment::eval(const glm::vec3& direction, const glm::vec3& normal) const {
    return evalTables(tables_, direction, normal);
}

void MapEnvironment::radianceStream(std::span<const glm::vec3> directions, std::span<Color> radiances) const {
    mapRadiance({map_, rotation_, tables_}, directions, radiances);
}

void MapEnvironment::sampleStream(int strategy, std::span<const glm::vec2> u, std::span<const glm::vec3> normals,
                                  std::span<EnvironmentSample> samples) const {
    sampleMap({map_, rotation_, tables_}, strategy, u, normals, samples);
}

void MapEnvironment::evalStream(std::span<const glm::vec3> directions, std::span<const glm::vec3> normals,
                                std::span<EnvironmentSample> samples) const {
    evalMap({map_, rotation_, tables_}, directions, normals, samples);
}

std::unique_ptr<const BedLight> MapEnvironment::makeBedLight() const { return std::make_unique<MapBedLight>(*this); }

}  // namespace stratum::shade
