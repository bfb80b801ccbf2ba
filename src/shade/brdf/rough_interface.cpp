#include "shade/brdf/rough_interface.h"

#include "base/parallel_for.h"
#include "shade/brdf/gloss_mixture.h"

#include <algorithm>
#include <cmath>

namespace stratum::shade {
namespace {

std::size_t indexOf(Side side) { return static_cast<std::size_t>(side); }

/// Smith's masking of one direction.
float masking(const Ggx& ggx, const glm::vec3& w) { return 2.0f * w.z / (w.z + ggx.stretch(w)); }

/// The refracted direction, in the frame of the other side; nothing for total reflection.
/// @param ratio  index on the side of wo over the other
std::optional<glm::vec3> refract(const glm::vec3& wo, const glm::vec3& h, float cosine, float ratio) {
    const float sine2 = ratio * ratio * (1.0f - cosine * cosine);
    if (!(sine2 < 1.0f)) return std::nullopt;
    const glm::vec3 through = (ratio * cosine - std::sqrt(1.0f - sine2)) * h - ratio * wo;
    return glm::vec3(through.x, through.y, -through.z);
}

}  // namespace

RoughInterface::RoughInterface(float eta, float alpha) : eta_(eta), ggx_(alpha) {
    for (const Side side : {Side::air, Side::solid}) {
        auto& table = lost_[indexOf(side)];
        parallelFor(kNodes, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i != end; ++i) {
                const float s = static_cast<float>(i) / (kNodes - 1);
                const double kept = singleAlbedo(side, std::max(s * s * s * s, GlossMixture::kGrazing));
                table[i] = static_cast<float>(std::clamp(1.0 - kept, 0.0, 1.0));
            }
        });
        // M times the cosine, summed over the table's straight pieces: cosine = s^4.
        auto& below = below_[indexOf(side)];
        double sum = 0.0;
        for (int i = 0; i < kSteps; ++i) {
            const double s = (i + 0.5) / kSteps;
            sum += static_cast<double>(lost(side, static_cast<float>(s * s * s * s))) * 8.0 * std::pow(s, 7.0) / kSteps;
            below[static_cast<std::size_t>(i) + 1] = static_cast<float>(sum);
        }
        mean_lost_[indexOf(side)] = static_cast<float>(sum);
        if (sum > 0.0)
            for (float& share : below) share /= static_cast<float>(sum);
    }
    // Shares in proportion to M eta^2: the only ones that make the lobes between the sides symmetric.
    const float air = mean_lost_[0];
    const float solid = mean_lost_[1] * eta_ * eta_;
    const float sum = air + solid;
    share_ = sum > 0.0f ? std::array<float, 2>{air / sum, solid / sum} : std::array<float, 2>{0.0f, 0.0f};
}

float RoughInterface::fresnel(Side from, float cosine) const {
    if (from == Side::air) return fresnelDielectric(cosine, eta_);
    const float outside2 = 1.0f - eta_ * eta_ * (1.0f - cosine * cosine);
    return outside2 > 0.0f ? fresnelDielectric(std::sqrt(outside2), eta_) : 1.0f;
}

float RoughInterface::lost(Side side, float cosine) const {
    const float s = std::sqrt(std::sqrt(std::clamp(cosine, 0.0f, 1.0f))) * (kNodes - 1);
    const int i = std::min(static_cast<int>(s), kNodes - 2);
    const float w = s - static_cast<float>(i);
    const auto& table = lost_[indexOf(side)];
    const auto n = static_cast<std::size_t>(i);
    return (1.0f - w) * table[n] + w * table[n + 1];
}

double RoughInterface::singleAlbedo(Side from, float cosine) const {
    // By quadrature over visible normals. Rings are closer where facets are steep: GGX has many of them, and they are
    // what loses light, from a sharp limit on.
    constexpr int kRings = 320;
    constexpr int kAngles = 36;
    const glm::vec3 wo(std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)), 0.0f, cosine);
    double sum = 0.0;
    for (int i = 0; i < kRings; ++i) {
        const double v = (i + 0.5) / kRings;
        double ring = 0.0;
        for (int j = 0; j < kAngles; ++j) {
            // wo is in the plane y = 0, so half of the angles are sufficient.
            const glm::vec2 u(0.5f * (static_cast<float>(j) + 0.5f) / kAngles, static_cast<float>(1.0 - v * v * v));
            const glm::vec3 h = ggx_.sampleVisible(wo, u);
            const float c = glm::dot(wo, h);
            if (!(c > 0.0f)) continue;
            const float f = fresnel(from, c);
            const glm::vec3 mirrored = 2.0f * c * h - wo;
            if (mirrored.z > 0.0f) ring += static_cast<double>(f * ggx_.shadowing(wo, mirrored));
            const auto through = refract(wo, h, c, ratio(from));
            if (through && through->z > 0.0f) ring += static_cast<double>((1.0f - f) * masking(ggx_, *through));
        }
        sum += ring / kAngles * 3.0 * v * v / kRings;
    }
    // The midpoint rule integrates 3 v^2 to 1 - 1 / (4 kRings^2).
    return sum / (1.0 - 0.25 / (kRings * kRings));
}

float RoughInterface::reflection(Side from, const glm::vec3& wo, const glm::vec3& wi) const {
    const glm::vec3 h = glm::normalize(wo + wi);
    const float cosine = std::max(0.0f, 0.5f * (glm::dot(wo, h) + glm::dot(wi, h)));
    return fresnel(from, cosine) * ggx_.d(h) * ggx_.visibility(wo, wi);
}

float RoughInterface::refraction(Side from, const glm::vec3& wo, const glm::vec3& wi) const {
    const float own = from == Side::air ? 1.0f : eta_;
    const float other = from == Side::air ? eta_ : 1.0f;
    const glm::vec3 through(wi.x, wi.y, -wi.z);
    glm::vec3 h = own * wo + other * through;
    const float length = glm::length(h);
    if (!(length > 0.0f)) return 0.0f;
    h /= h.z < 0.0f ? -length : length;
    const float co = glm::dot(wo, h);
    const float ci = glm::dot(through, h);
    if (!(co > 0.0f && ci < 0.0f)) return 0.0f;
    const float sum = own * co + other * ci;
    const float jacobian = other * other * -ci / (sum * sum);
    // The density of visible facets, D G1(wo) co / wo.z with G1(wo) / wo.z = 2 / (wo.z + stretch), in directions.
    const float density = 2.0f * ggx_.d(h) * co / (wo.z + ggx_.stretch(wo)) * jacobian;
    return (1.0f - fresnel(from, co)) * density * masking(ggx_, wi) / wi.z;
}

float RoughInterface::eval(Side from, const glm::vec3& wo, Side to, const glm::vec3& wi) const {
    if (!(GlossMixture::above(wo) && GlossMixture::above(wi))) return 0.0f;
    float value = from == to ? reflection(from, wo, wi) : refraction(from, wo, wi);
    if (mean_lost_[indexOf(to)] > 0.0f)
        value += share(to) * lost(from, wo.z) * lost(to, wi.z) / mean_lost_[indexOf(to)] * kInvPi;
    return value;
}

std::optional<RoughInterface::Facet> RoughInterface::sampleFacet(Side from, const glm::vec3& wo, float& lobe,
                                                                 const glm::vec2& u) const {
    const glm::vec3 h = ggx_.sampleVisible(wo, u);
    const float c = glm::dot(wo, h);
    if (!(c > 0.0f)) return std::nullopt;
    const float f = fresnel(from, c);
    if (lobe < f) {
        lobe /= f;
        const glm::vec3 wi = 2.0f * c * h - wo;
        if (!GlossMixture::above(wi)) return std::nullopt;
        return Facet{from, wi, ggx_.shadowing(wo, wi)};
    }
    lobe = (lobe - f) / (1.0f - f);
    const auto wi = refract(wo, h, c, ratio(from));
    if (!wi || !GlossMixture::above(*wi)) return std::nullopt;
    return Facet{opposite(from), *wi, masking(ggx_, *wi)};
}

glm::vec3 RoughInterface::sampleDiffuse(Side to, float cosine_draw, float angle_draw) const {
    const auto& below = below_[indexOf(to)];
    const auto above = std::upper_bound(below.begin() + 1, below.end() - 1, cosine_draw);
    const auto i = static_cast<std::size_t>(above - below.begin());
    const float width = below[i] - below[i - 1];
    const float t = width > 0.0f ? std::clamp((cosine_draw - below[i - 1]) / width, 0.0f, 1.0f) : 0.5f;
    const float s = (static_cast<float>(i - 1) + t) / kSteps;
    const float cosine = std::min(s * s * s * s, 1.0f);
    const float sine = std::sqrt(1.0f - cosine * cosine);
    const float phi = 2.0f * kPi * angle_draw;
    return {sine * std::cos(phi), sine * std::sin(phi), cosine};
}

std::optional<InterfaceSample> RoughInterface::sample(Side from, const glm::vec3& wo, glm::vec2 lobe,
                                                      const glm::vec2& u) const {
    if (!GlossMixture::above(wo)) return std::nullopt;
    InterfaceSample out;
    const std::optional<Facet> facet = sampleFacet(from, wo, lobe.x, u);
    if (facet && lobe.x < facet->seen) {
        out.side = facet->side;
        out.wi = glm::normalize(facet->wi);
    } else if (share_[0] + share_[1] > 0.0f) {
        const float rest = facet ? (lobe.x - facet->seen) / (1.0f - facet->seen) : lobe.x;
        const float air = share(Side::air);
        out.side = lobe.y < air ? Side::air : Side::solid;
        out.wi = sampleDiffuse(out.side, lobe.y < air ? lobe.y / air : (lobe.y - air) / (1.0f - air), rest);
    } else {
        return std::nullopt;
    }
    out.pdf = pdf(from, wo, out.side, out.wi);
    if (!(out.pdf > 0.0f) || !std::isfinite(out.pdf)) return std::nullopt;
    return out;
}

}  // namespace stratum::shade
