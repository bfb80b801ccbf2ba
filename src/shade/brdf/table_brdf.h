// The BRDF of a measured table.
#pragma once

#include "shade/brdf/brdf.h"
#include "shade/brdf/half_diff_table.h"
#include "shade/brdf/lobe_fit.h"
#include "shade/brdf/microfacet.h"

#include <glm/common.hpp>

#include <array>
#include <span>
#include <vector>

namespace stratum::shade {

/// Looks up a table; samples a mixture of the cosine and the GGX lobe fitted to it.
///
/// Measured tables need not conserve energy, particularly where they are extrapolated. The directional albedo a is
/// tabulated at construction and every value scaled by min(s(wo), s(wi)), s = min(1, 1 / a) per channel: reciprocal,
/// and no albedo above 1.
class TableBrdf final : public Brdf {
public:
    /// @param lobes  per channel, fitted to the table; used for sampling only
    /// @param notes  see Brdf::notes
    TableBrdf(HalfDiffTable table, const std::array<Lobes, 3>& lobes, std::vector<std::string> notes);
    Color eval(const glm::vec3& wo, const glm::vec3& wi) const override;
    std::optional<BrdfSample> sample(const glm::vec3& wo, float lobe, const glm::vec2& u) const override;
    float pdf(const glm::vec3& wo, const glm::vec3& wi) const override;
    void evalStream(std::span<const glm::vec3> wo, std::span<const glm::vec3> wi, std::span<Color> values,
                    std::span<float> densities) const override;
    void sampleStream(std::span<const glm::vec3> wo, std::span<const float> lobes, std::span<const glm::vec2> u,
                      std::span<BrdfSample> samples) const override;
    const std::vector<std::string>& notes() const override { return notes_; }

    /// The largest directional albedo of the table, before scaling.
    float tableAlbedo() const { return table_albedo_; }
    const HalfDiffTable& table() const { return table_; }

private:
    class LookUps;
    static constexpr int kNodes = 65;  // in sqrt(cosine): albedo changes fastest at grazing angles

    struct Place {
        std::size_t low;
        float weight;
    };
    static Place place(float cosine);
    Color scale(float cosine) const;
    float glossShare(float cosine) const;
    Color albedo(const glm::vec3& wo) const;
    /// What is made of a value of the table.
    Color scaled(const Color& value, const glm::vec3& wo, const glm::vec3& wi) const {
        return scaled_ ? value * glm::min(scale(wo.z), scale(wi.z)) : value;
    }

    HalfDiffTable table_;
    Ggx ggx_{0.3f};
    std::array<Color, kNodes> scale_{};
    std::array<float, kNodes> gloss_share_{};
    bool scaled_ = false;
    float table_albedo_ = 0.0f;
    std::vector<std::string> notes_;
};

}  // namespace stratum::shade
