#include "shade/environment/map_environment.h"

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

/// For sampling combined with a BRDF.
std::vector<BilinearDistribution> compensatedTables(const LightMap& map, double rotation) {
    Split split = splitOf(luminances(map), map.width, map.height);
    split.others = compensated(std::move(split.others), map.width, map.height);
    return tablesOf(std::move(split), map.width, map.height, [rotation](const glm::dvec2& uv) {
        const double theta = std::numbers::pi * uv.y;
        const double phi = 2.0 * std::numbers::pi * (0.5 - uv.x) + rotation;
        const double sine = std::sin(theta);
        return glm::vec3(sine * std::cos(phi), sine * std::sin(phi), std::cos(theta));
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

/// Samples by the map's own texels, so that a sun is never missed.
class MapBedSampler final : public EnvironmentSampler {
public:
    MapBedSampler(const LightMap& map, double rotation) : map_(map), rotation_(rotation), tables_(cosineTables(map)) {}
    int strategies() const override { return static_cast<int>(tables_.size()); }
    void sampleStream(int strategy, std::span<const glm::vec2> u, std::span<const glm::vec3>,
                      std::span<EnvironmentSample> samples) const override {
        sampleMap({map_, rotation_, tables_}, strategy, u, {}, samples);
    }
    void evalStream(std::span<const glm::vec3> directions, std::span<const glm::vec3>,
                    std::span<EnvironmentSample> samples) const override {
        evalMap({map_, rotation_, tables_}, directions, {}, samples);
    }

private:
    const LightMap& map_;
    double rotation_;
    std::vector<BilinearDistribution> tables_;
};

}  // namespace

MapEnvironment::MapEnvironment(LightMap map, double rotation, float scale, bool visible,
                               std::shared_ptr<const Light> sun)
    : map_(scaled(std::move(map), scale)),
      rotation_(rotation),
      visible_(visible),
      sun_(std::move(sun)),
      tables_(compensatedTables(map_, rotation_)) {}

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

std::unique_ptr<const EnvironmentSampler> MapEnvironment::makeBedSampler() const {
    return std::make_unique<MapBedSampler>(map_, rotation_);
}

Color MapEnvironment::irradianceFromAbove() const {
    // A row's weight: the integral of its share in the interpolation between rows, times the cosine.
    constexpr int kSteps = 16;  // a row; the horizon lies between two of them
    const double step = std::numbers::pi / (map_.height * kSteps);
    std::vector<double> weights(static_cast<std::size_t>(map_.height), 0.0);
    for (int n = 0; 2 * n < map_.height * kSteps; ++n) {
        const double theta = (n + 0.5) * step;
        const double row = std::clamp((n + 0.5) / kSteps - 0.5, 0.0, map_.height - 1.0);
        const auto low = static_cast<std::size_t>(row);
        const double share = row - static_cast<double>(low);
        const double weight = std::sin(theta) * std::cos(theta) * step;
        weights[low] += (1.0 - share) * weight;
        weights[std::min(low + 1, weights.size() - 1)] += share * weight;
    }
    const auto width = static_cast<std::size_t>(map_.width);
    glm::dvec3 sum(0.0);
    for (std::size_t y = 0; y < weights.size() && weights[y] > 0.0; ++y) {
        glm::dvec3 row(0.0);
        for (std::size_t x = 0; x < width; ++x) row += glm::dvec3(map_.texels[y * width + x]);
        sum += weights[y] * row;
    }
    return Color(sum * (2.0 * std::numbers::pi / map_.width));
}

}  // namespace stratum::shade
