#include "shade/environment/environment.h"

#include "base/error.h"
#include "base/names.h"
#include "shade/angles.h"
#include "shade/brdf/preset.h"
#include "shade/camera/sampling.h"
#include "shade/environment/map_environment.h"
#include "shade/environment/studio_and_sky.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <vector>

namespace stratum::shade {

namespace {

constexpr std::string_view kOption = "--env";
constexpr std::array<std::string_view, 3> kPresets = {"studio", "sky", "constant"};

std::string nameOf(std::string_view text) { return std::string(text.substr(0, text.find(':'))); }

std::shared_ptr<const Environment> skyOf(Preset preset, const EnvironmentPlacement& placement) {
    SkyOptions sky;
    // Behind the camera's left shoulder: three eighths of a turn clockwise from its right-hand side.
    sky.azimuth = placement.azimuth - 0.75 * std::numbers::pi;
    if (!preset.values.empty()) {
        if (preset.values.size() == 2) preset.values.push_back(static_cast<float>(sky.turbidity));
        requireValues(preset, 3, kOption, "sky:ELEVATION,AZIMUTH,TURBIDITY");
        requireRange(preset, 0, 1.0f, 90.0f, kOption, "the sun's elevation in degrees");
        requireRange(preset, 1, -360.0f, 360.0f, kOption, "the sun's azimuth in degrees");
        requireRange(preset, 2, 2.0f, 8.0f, kOption, "the turbidity");
        sky.elevation = static_cast<double>(preset.values[0]) * kRadians;
        sky.azimuth = static_cast<double>(preset.values[1]) * kRadians;
        sky.turbidity = static_cast<double>(preset.values[2]);
    }
    sky.azimuth += placement.rotation;
    return makeSky(sky);
}

/// By the cosine to +z.
class CosineSampler final : public EnvironmentSampler {
public:
    explicit CosineSampler(const Environment& environment) : environment_(environment) {}
    void sampleStream(int, std::span<const glm::vec2> u, std::span<const glm::vec3> normals,
                      std::span<EnvironmentSample> samples) const override {
        std::vector<glm::vec3> directions(u.size());
        std::transform(u.begin(), u.end(), directions.begin(), toCosineHemisphere);
        evalStream(directions, normals, samples);
    }
    void evalStream(std::span<const glm::vec3> directions, std::span<const glm::vec3>,
                    std::span<EnvironmentSample> samples) const override {
        std::vector<Color> radiances(directions.size());
        environment_.radianceStream(directions, radiances);
        for (std::size_t n = 0; n < directions.size(); ++n)
            samples[n] = {directions[n], radiances[n], std::max(directions[n].z, 0.0f) * kInvPi};
    }

private:
    const Environment& environment_;
};

}  // namespace

std::unique_ptr<const EnvironmentSampler> Environment::makeBedSampler() const {
    return std::make_unique<CosineSampler>(*this);
}

EnvironmentSample EnvironmentSampler::sample(int strategy, const glm::vec2& u, const glm::vec3& normal) const {
    EnvironmentSample sample;
    sampleStream(strategy, {&u, 1}, {&normal, 1}, {&sample, 1});
    return sample;
}

EnvironmentSample EnvironmentSampler::eval(const glm::vec3& direction, const glm::vec3& normal) const {
    EnvironmentSample sample;
    evalStream({&direction, 1}, {&normal, 1}, {&sample, 1});
    return sample;
}

Color Environment::radiance(const glm::vec3& direction) const {
    Color radiance(0.0f);
    radianceStream({&direction, 1}, {&radiance, 1});
    return radiance;
}

Color Environment::irradianceFromAbove() const {
    // Uniform in azimuth and in squared sine, which is the density of the cosine.
    constexpr int kRings = 256;
    constexpr int kAngles = 512;
    glm::dvec3 sum(0.0);
    std::vector<glm::vec3> ring(kAngles);
    std::vector<Color> radiances(kAngles);
    for (int i = 0; i < kRings; ++i) {
        const double sine2 = (i + 0.5) / kRings;
        const double r = std::sqrt(sine2);
        const double z = std::sqrt(1.0 - sine2);
        for (int j = 0; j < kAngles; ++j) {
            const double phi = 2.0 * std::numbers::pi * (j + 0.5) / kAngles;
            ring[static_cast<std::size_t>(j)] = glm::vec3(r * std::cos(phi), r * std::sin(phi), z);
        }
        radianceStream(ring, radiances);
        for (const Color& radiance : radiances) sum += glm::dvec3(radiance);
    }
    return Color(sum * (std::numbers::pi / (kRings * kAngles)));
}

bool isEnvironmentPreset(std::string_view text) {
    return std::find(kPresets.begin(), kPresets.end(), nameOf(text)) != kPresets.end();
}

std::shared_ptr<const Environment> makeEnvironment(std::string_view text, const EnvironmentPlacement& placement) {
    if (!(placement.exposure >= -30.0 && placement.exposure <= 30.0))
        throw UsageError(fmt::format("--env-exposure {}: must be from -30 to 30 stops", placement.exposure));
    if (!std::isfinite(placement.rotation)) throw UsageError("--env-rotation: must be a number of degrees");
    if (std::error_code error;
        !isEnvironmentPreset(text) && !text.empty() && std::filesystem::exists(std::filesystem::path(text), error))
        return std::make_shared<MapEnvironment>(readLightMap(text, placement.exposure), placement.rotation, 1.0f);
    const std::string name = nameOf(text);
    if (!isEnvironmentPreset(text))
        throw UsageError(
            fmt::format("{} {}: is no file; write the name of a .hdr or .exr map, studio, sky or constant:R,G,B{}",
                        kOption, text, didYouMean(name, kPresets)));
    const Preset preset = parsePreset(text, kOption);
    if (placement.exposure != 0.0)
        throw UsageError(fmt::format("--env-exposure is for maps from files; --env {} needs none", text));
    if (name == "sky") return skyOf(preset, placement);
    if (name == "studio") {
        requireValues(preset, 0, kOption, "studio");
        EnvironmentPlacement turned = placement;
        turned.azimuth += placement.rotation;
        return makeStudio(turned);
    }
    requireValues(preset, 3, kOption, "constant:R,G,B");
    for (std::size_t i = 0; i < 3; ++i) requireRange(preset, i, 0.0f, 1e6f, kOption, "a radiance");
    return std::make_shared<ConstantEnvironment>(Color(preset.values[0], preset.values[1], preset.values[2]));
}

namespace {

constexpr float kDensity = 0.25f * kInvPi;  // of the whole sphere

}  // namespace

void ConstantEnvironment::radianceStream(std::span<const glm::vec3>, std::span<Color> radiances) const {
    std::fill(radiances.begin(), radiances.end(), radiance_);
}

void ConstantEnvironment::sampleStream(int, std::span<const glm::vec2> u, std::span<const glm::vec3>,
                                       std::span<EnvironmentSample> samples) const {
    for (std::size_t n = 0; n < u.size(); ++n) samples[n] = {toSphere(u[n]), radiance_, kDensity};
}

void ConstantEnvironment::evalStream(std::span<const glm::vec3> directions, std::span<const glm::vec3>,
                                     std::span<EnvironmentSample> samples) const {
    for (std::size_t n = 0; n < directions.size(); ++n) samples[n] = {directions[n], radiance_, kDensity};
}

}  // namespace stratum::shade
