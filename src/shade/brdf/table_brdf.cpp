#include "shade/brdf/table_brdf.h"

#include "base/parallel_for.h"
#include "shade/brdf/gloss_mixture.h"

#include <cmath>
#include <cstddef>

namespace stratum::shade {

/// Pairs of directions above the surface that wait for their values, and where these go.
class TableBrdf::LookUps {
public:
    explicit LookUps(const TableBrdf& brdf) : brdf_(brdf) {}
    /// @param set  gets `to` and the value, now or later
    void add(std::size_t to, const glm::vec3& wo, const glm::vec3& wi, const auto& set) {
        wo_[count_] = wo;
        wi_[count_] = wi;
        to_[count_] = to;
        if (++count_ == kAtOnce) finish(set);
    }
    void finish(const auto& set) {
        brdf_.table_.at(std::span(wo_).first(count_), std::span(wi_).first(count_), values_);
        for (std::size_t k = 0; k < count_; ++k) set(to_[k], brdf_.scaled(values_[k], wo_[k], wi_[k]));
        count_ = 0;
    }

private:
    static constexpr std::size_t kAtOnce = 64;  // a few kilobytes, on the stack
    const TableBrdf& brdf_;
    std::array<glm::vec3, kAtOnce> wo_, wi_;
    std::array<Color, kAtOnce> values_;
    std::array<std::size_t, kAtOnce> to_;
    std::size_t count_ = 0;
};

TableBrdf::TableBrdf(HalfDiffTable table, const std::array<Lobes, 3>& lobes, std::vector<std::string> notes)
    : table_(std::move(table)), notes_(std::move(notes)) {
    // One lobe for all channels, slightly too wide: undersampled tails would be noisy.
    double weight = 0.0;
    double log_alpha = 0.0;
    Color body(0.0f);
    for (int c = 0; c < 3; ++c) {
        const Lobes& l = lobes[static_cast<std::size_t>(c)];
        weight += l.ks;
        log_alpha += l.ks * std::log(l.alpha);
        body[c] = static_cast<float>(std::min(l.kd, 1.0));
    }
    ggx_ = Ggx(static_cast<float>(std::clamp(1.1 * std::exp(log_alpha / std::max(weight, 1e-12)), 0.005, 1.0)));
    // The albedo's quadrature needs a density, whose lobe weights depend on the albedo: it starts with equal weights.
    gloss_share_.fill(0.5f);
    scale_.fill(Color(1.0f));
    std::array<float, kNodes> shares{};
    bool scaled = false;
    std::array<Color, kNodes> albedos;
    parallelFor(kNodes, 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t n = first; n < last; ++n) {
            const float s = std::max(static_cast<float>(n) / (kNodes - 1), 0.01f);
            const float cosine = s * s;
            albedos[n] = albedo({std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)), 0.0f, cosine});
        }
    });
    for (std::size_t n = 0; n < kNodes; ++n) {
        const Color& a = albedos[n];
        table_albedo_ = std::max(table_albedo_, maxComponent(a));
        // Slightly below 1, so that errors of quadrature and interpolation don't exceed it.
        for (int c = 0; c < 3; ++c) scale_[n][c] = a[c] > 0.995f ? 0.995f / a[c] : 1.0f;
        scaled = scaled || std::min({scale_[n].r, scale_[n].g, scale_[n].b}) < 1.0f;
        const float all = std::max(luminance(a), 1e-6f);
        shares[n] = std::clamp(1.0f - luminance(body) / all, 0.2f, 0.9f);
    }
    gloss_share_ = shares;
    scaled_ = scaled;
}

TableBrdf::Place TableBrdf::place(float cosine) {
    const float s = std::sqrt(std::clamp(cosine, 0.0f, 1.0f)) * (kNodes - 1);
    const int low = std::min(static_cast<int>(s), kNodes - 2);
    return {static_cast<std::size_t>(low), s - static_cast<float>(low)};
}

Color TableBrdf::scale(float cosine) const {
    const Place p = place(cosine);
    return (1.0f - p.weight) * scale_[p.low] + p.weight * scale_[p.low + 1];
}

float TableBrdf::glossShare(float cosine) const {
    const Place p = place(cosine);
    return (1.0f - p.weight) * gloss_share_[p.low] + p.weight * gloss_share_[p.low + 1];
}

Color TableBrdf::albedo(const glm::vec3& wo) const {
    constexpr int kSide = 64;
    glm::dvec3 sum(0.0);
    for (int i = 0; i < kSide; ++i) {
        for (int j = 0; j < kSide; ++j) {
            // Half of the points in each lobe, together of the density of the mixture.
            for (const float lobe : {0.25f, 0.75f}) {
                const glm::vec2 u((static_cast<float>(i) + 0.5f) / kSide, (static_cast<float>(j) + 0.5f) / kSide);
                if (const auto s = sample(wo, lobe, u)) sum += glm::dvec3(s->f * (s->wi.z / s->pdf));
            }
        }
    }
    return Color(sum / (2.0 * kSide * kSide));
}

Color TableBrdf::eval(const glm::vec3& wo, const glm::vec3& wi) const {
    if (!(GlossMixture::above(wo) && GlossMixture::above(wi))) return Color(0.0f);
    return scaled(table_.at(wo, wi), wo, wi);
}

float TableBrdf::pdf(const glm::vec3& wo, const glm::vec3& wi) const {
    return GlossMixture{ggx_, glossShare(wo.z)}.pdf(wo, wi);
}

std::optional<BrdfSample> TableBrdf::sample(const glm::vec3& wo, float lobe, const glm::vec2& u) const {
    return GlossMixture{ggx_, glossShare(wo.z)}.sample(*this, wo, lobe, u);
}

void TableBrdf::evalStream(std::span<const glm::vec3> wo, std::span<const glm::vec3> wi, std::span<Color> values,
                           std::span<float> densities) const {
    LookUps lookups(*this);
    const auto set = [&](std::size_t n, const Color& value) { values[n] = value; };
    for (std::size_t n = 0; n < wo.size(); ++n) {
        values[n] = Color(0.0f);
        densities[n] = pdf(wo[n], wi[n]);
        if (GlossMixture::above(wo[n]) && GlossMixture::above(wi[n])) lookups.add(n, wo[n], wi[n], set);
    }
    lookups.finish(set);
}

void TableBrdf::sampleStream(std::span<const glm::vec3> wo, std::span<const float> lobes, std::span<const glm::vec2> u,
                             std::span<BrdfSample> samples) const {
    LookUps lookups(*this);
    const auto set = [&](std::size_t n, const Color& value) { samples[n].f = value; };
    for (std::size_t n = 0; n < wo.size(); ++n) {
        samples[n] = GlossMixture{ggx_, glossShare(wo[n].z)}.draw(wo[n], lobes[n], u[n]);
        if (samples[n].pdf > 0.0f) lookups.add(n, wo[n], samples[n].wi, set);
    }
    lookups.finish(set);
}

}  // namespace stratum::shade
