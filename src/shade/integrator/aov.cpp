#include "shade/integrator/aov.h"

#include "base/error.h"
#include "base/names.h"
#include "base/text.h"
#include "shade/frame.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace stratum::shade {
namespace {

struct Kind {
    Aov aov;
    std::string_view name;
    std::vector<std::string> channels;
};

const std::array<Kind, 11>& kinds() {
    static const std::array<Kind, 11> all = {{{Aov::normal, "normal", {"X", "Y", "Z"}},
                                              {Aov::depth, "depth", {"Z"}},
                                              {Aov::position, "position", {"X", "Y", "Z"}},
                                              {Aov::albedo, "albedo", {"R", "G", "B"}},
                                              {Aov::shading, "shading", {"M", "G"}},
                                              {Aov::mask, "mask", {"V"}},
                                              {Aov::variance, "variance", {"V"}},
                                              {Aov::samples, "samples", {"V"}},
                                              {Aov::layer, "layer", {"V"}},
                                              {Aov::tool, "tool", {"V"}},
                                              {Aov::feature, "feature", {"V"}}}};
    return all;
}

const Kind& kindOf(Aov aov) { return kinds()[static_cast<std::size_t>(aov)]; }

std::optional<Label> labelOf(Aov aov) {
    if (aov == Aov::layer) return Label::layer;
    if (aov == Aov::tool) return Label::tool;
    if (aov == Aov::feature) return Label::feature;
    return std::nullopt;
}

bool geometric(Aov aov) { return aov != Aov::variance && aov != Aov::samples; }

}  // namespace

std::vector<std::string> aovNames() {
    std::vector<std::string> names;
    for (const Kind& kind : kinds()) names.emplace_back(kind.name);
    return names;
}

std::vector<Aov> parseAovs(std::string_view text) {
    std::vector<Aov> aovs;
    for (const std::string_view word : splitList(text)) {
        const auto found =
            std::find_if(kinds().begin(), kinds().end(), [word](const Kind& k) { return k.name == word; });
        if (found == kinds().end()) {
            const std::vector<std::string> all = aovNames();
            const std::vector<std::string_view> names(all.begin(), all.end());
            throw UsageError(fmt::format("--aov {}: unknown layer; choose from {}{}", word, fmt::join(names, ", "),
                                         didYouMean(word, names)));
        }
        if (std::find(aovs.begin(), aovs.end(), found->aov) == aovs.end()) aovs.push_back(found->aov);
    }
    return aovs;
}

std::vector<Label> labelsOf(const std::vector<Aov>& aovs) {
    std::vector<Label> labels;
    for (const Aov aov : aovs)
        if (const auto label = labelOf(aov)) labels.push_back(*label);
    return labels;
}

std::vector<FilmLayer> makeLayers(const std::vector<Aov>& aovs, std::size_t pixels) {
    std::vector<FilmLayer> layers;
    for (const Aov aov : aovs) {
        const Kind& kind = kindOf(aov);
        layers.push_back({std::string(kind.name), kind.channels, std::vector<float>(pixels * kind.channels.size())});
    }
    return layers;
}

std::size_t sumsOf(const std::vector<Aov>& aovs) {
    std::size_t sums = 0;
    for (const Aov aov : aovs)
        if (geometric(aov)) sums += kindOf(aov).channels.size();
    return sums;
}

void storeAovs(const std::vector<Aov>& aovs, std::span<const double> sums, const PixelStatistics& statistics,
               std::vector<FilmLayer>& layers, std::size_t pixel) {
    auto sum = sums.begin();
    for (std::size_t n = 0; n < aovs.size(); ++n) {
        const std::size_t channels = layers[n].channels.size();
        float* out = &layers[n].values[pixel * channels];
        if (aovs[n] == Aov::variance)
            *out = static_cast<float>(statistics.variance);
        else if (aovs[n] == Aov::samples)
            *out = static_cast<float>(statistics.samples);
        else if (labelOf(aovs[n]))
            *out = static_cast<float>(*sum++ - 1.0);
        else
            for (std::size_t c = 0; c < channels; ++c) out[c] = static_cast<float>(*sum++ / statistics.samples);
    }
}

AovRecorder::AovRecorder(const SceneDescription& scene, const trace::Intersector& print, std::vector<Aov> aovs)
    : surfaces_(scene, print), aovs_(std::move(aovs)), bare_bed_(scene.catcher ? scene.catcher->bare : 0.0f) {
    if (std::find(aovs_.begin(), aovs_.end(), Aov::shading) != aovs_.end()) {
        const trace::Box box = print.bounds();
        const glm::dvec3 middle = 0.5 * (box.min + box.max);
        const bool endless = !std::isfinite(middle.x + middle.y + middle.z);
        bare_light_.emplace(scene, endless ? scene.camera.eye() : middle, scene.anyByPlace());
    }
}

float AovRecorder::glintOf(const SurfacePoint& point, const glm::dvec3& direction) const {
    const Flakes flakes = point.brdf->flakes();
    if (!(flakes.strength > 0.0f)) return 0.0f;
    const Frame frame{glm::vec3(point.normal)};
    const glm::vec3 wo = frame.toLocal(glm::vec3(-direction));
    float sum = 0.0f;
    for (const glm::vec2& slope : {flakes.slope, -flakes.slope}) {
        const glm::vec3 facet = glm::normalize(glm::vec3(slope, 1.0f));
        const float cosine = glm::dot(wo, facet);
        const glm::vec3 mirror = 2.0f * cosine * facet - wo;
        if (cosine > 0.0f && mirror.z > 0.0f) sum += bare_light_->glint(frame.toWorld(mirror));
    }
    return 0.5f * flakes.strength * sum;
}

void AovRecorder::add(const SurfacePoint& point, const glm::dvec3& direction, std::span<double> sums) const {
    if (aovs_.empty() || !std::isfinite(point.t)) return;
    auto sum = sums.begin();
    const auto add1 = [&](double value) { *sum++ += value; };
    const auto add3 = [&](const glm::dvec3& v) {
        for (int k = 0; k < 3; ++k) add1(v[k]);
    };
    const double share = 1.0 - static_cast<double>(surfaces_.fade(point));
    for (const Aov aov : aovs_) {
        switch (aov) {
            case Aov::normal:
                add3(share * point.normal);
                break;
            case Aov::depth:
                add1(share * point.t);
                break;
            case Aov::position:
                add3(share * point.position);
                break;
            case Aov::albedo:
                add3(share * glm::dvec3(point.albedo));
                break;
            case Aov::shading: {
                const glm::dvec3 mirror = direction - 2.0 * glm::dot(direction, point.normal) * point.normal;
                add1(share * static_cast<double>(bare_light_->matt(glm::vec3(point.normal))));
                add1(share * static_cast<double>(bare_light_->gloss(glm::vec3(mirror)) + glintOf(point, direction)));
                break;
            }
            case Aov::mask:
                add1(point.bed ? 0.0 : 1.0);
                break;
            case Aov::layer:
            case Aov::tool:
            case Aov::feature: {
                // Stored one higher, so that 0 means "not set". The first sample that has one sets it.
                const float value = point.labels[static_cast<std::size_t>(*labelOf(aov))];
                const bool first = *sum == 0.0 && value >= 0.0f;
                add1(first ? static_cast<double>(value) + 1.0 : 0.0);
                break;
            }
            case Aov::variance:
            case Aov::samples:
                break;
        }
    }
}

}  // namespace stratum::shade
