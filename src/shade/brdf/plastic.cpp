#include "shade/brdf/plastic.h"

#include "shade/brdf/gloss_mixture.h"

#include <cmath>

namespace stratum::shade {
namespace {

/// Directional albedo of the coat by quadrature over visible normals, which flattens the integrand for every alpha.
double quadrature(const Ggx& ggx, float cosine) {
    constexpr int kRings = 96;
    constexpr int kAngles = 64;
    const glm::vec3 wo(std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)), 0.0f, cosine);
    double sum = 0.0;
    for (int i = 0; i < kRings; ++i) {
        for (int j = 0; j < kAngles; ++j) {
            // wo is in the plane y = 0, so half of the angles are sufficient.
            const glm::vec2 u(0.5f * (static_cast<float>(j) + 0.5f) / kAngles, (static_cast<float>(i) + 0.5f) / kRings);
            const glm::vec3 h = ggx.sampleVisible(wo, u);
            const float c = glm::dot(wo, h);
            const glm::vec3 wi = 2.0f * c * h - wo;
            if (c > 0.0f && wi.z > 0.0f)
                sum += static_cast<double>(fresnelDielectric(c, Plastic::kEta) * ggx.shadowing(wo, wi));
        }
    }
    return sum / (kRings * kAngles);
}

}  // namespace

Plastic::Plastic(const Color& body, float alpha) : body_(body), body_max_(maxComponent(body)), ggx_{alpha} {
    for (int i = 0; i < kNodes; ++i) {
        const float s = static_cast<float>(i) / (kNodes - 1);
        table_[static_cast<std::size_t>(i)] =
            static_cast<float>(quadrature(ggx_, std::max(s * s * s * s, GlossMixture::kGrazing)));
    }
    // Eavg = integral of E 2 cos dcos = integral of E(s) 8 s^7 ds, for the table's straight pieces; each is cut finely
    // enough for Simpson's rule to be exact to float rounding.
    double mean = 0.0;
    constexpr int kCuts = 16;
    const auto integrand = [this](double s) {
        return static_cast<double>(coatAlbedo(static_cast<float>(s * s * s * s))) * 8.0 * std::pow(s, 7.0);
    };
    const int pieces = (kNodes - 1) * kCuts;
    for (int i = 0; i < pieces; ++i) {
        const double a = static_cast<double>(i) / pieces;
        const double b = static_cast<double>(i + 1) / pieces;
        mean += (b - a) / 6.0 * (integrand(a) + 4.0 * integrand(0.5 * (a + b)) + integrand(b));
    }
    one_minus_mean_ = static_cast<float>(1.0 - mean);
}

std::shared_ptr<const Brdf> Plastic::recolored(const Color& body) const {
    auto other = std::make_shared<Plastic>(*this);  // the coat's table doesn't depend on the body
    other->body_ = body;
    other->body_max_ = maxComponent(body);
    return other;
}

float Plastic::coatAlbedo(float cosine) const {
    const float s = std::sqrt(std::sqrt(std::clamp(cosine, 0.0f, 1.0f))) * (kNodes - 1);
    const int i = std::min(static_cast<int>(s), kNodes - 2);
    const float w = s - static_cast<float>(i);
    const auto n = static_cast<std::size_t>(i);
    return (1.0f - w) * table_[n] + w * table_[n + 1];
}

float Plastic::coatShare(float cosine) const {
    // Proportional to the lobes' reflectances, but with more samples for the coat, which reflects small bright lights.
    const float e = coatAlbedo(cosine);
    return std::max(e / (e + (1.0f - e) * body_max_), 0.3f);
}

float Plastic::coat(const glm::vec3& wo, const glm::vec3& wi, const glm::vec3& h) const {
    // wo.h and wi.h are equal except for rounding; with their mean f(a, b) and f(b, a) are bit-identical.
    const float c = std::max(0.0f, 0.5f * (glm::dot(wo, h) + glm::dot(wi, h)));
    return fresnelDielectric(c, kEta) * ggx_.d(h) * ggx_.visibility(wo, wi);
}

Color Plastic::eval(const glm::vec3& wo, const glm::vec3& wi) const {
    if (!(GlossMixture::above(wo) && GlossMixture::above(wi))) return Color(0.0f);
    const float body = (1.0f - coatAlbedo(wo.z)) * (1.0f - coatAlbedo(wi.z)) / one_minus_mean_ * kInvPi;
    return body_ * body + Color(coat(wo, wi, glm::normalize(wo + wi)));
}

float Plastic::pdf(const glm::vec3& wo, const glm::vec3& wi) const {
    return GlossMixture{ggx_, coatShare(wo.z)}.pdf(wo, wi);
}

std::optional<BrdfSample> Plastic::sample(const glm::vec3& wo, float lobe, const glm::vec2& u) const {
    return GlossMixture{ggx_, coatShare(wo.z)}.sample(*this, wo, lobe, u);
}

}  // namespace stratum::shade
