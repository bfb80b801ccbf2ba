// Glitter filament: plastic with mirror-like flakes, each of which flashes on its own.
#pragma once

#include "shade/brdf/brdf.h"
#include "shade/brdf/plastic.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace stratum::shade {

/// Two flakes that lean the same way to opposite sides: a V.
///
/// f = F D G / (4 cos cos). D is the density of facets whose slopes are spread about +slope and -slope, half of them
/// each, by GGX's slope distribution of a small alpha; G is the masking and shadowing of V-shaped grooves, min(1, 2 n.h
/// n.o / o.h, 2 n.h n.i / o.h). Since facets come in symmetric pairs, what of them is seen from any direction adds up
/// to the surface itself: no pair reflects more than it gets. Sources: K. Torrance, E. Sparrow, JOSA 57(9) 1967 (V
/// grooves); E. Heitz, JCGT 3(2) 2014 (slopes); W. Jakob et al., "Discrete Stochastic Microfacet Models", SIGGRAPH 2014
/// (D of single flakes instead of a smooth one).
class FlakePair final : public Brdf {
public:
    /// @param color  reflectance at normal incidence (Schlick), in [0, 1]
    /// @param slope  tangent of the angle by which they lean, along x and y
    /// @param alpha  GGX's, of how far from flat a flake is, > 0
    FlakePair(const Color& color, const glm::vec2& slope, float alpha) : color_(color), slope_(slope), alpha_(alpha) {}
    Color eval(const glm::vec3& wo, const glm::vec3& wi) const override;
    std::optional<BrdfSample> sample(const glm::vec3& wo, float lobe, const glm::vec2& u) const override;
    float pdf(const glm::vec3& wo, const glm::vec3& wi) const override;
    /// Without a share of the area.
    Flakes flakes() const override;

private:
    /// Density of facet normals, per steradian of projected area.
    float density(const glm::vec3& h) const;

    Color color_;
    glm::vec2 slope_;
    float alpha_;
};

/// f = s f_flakes + (1 - s) f_plastic, a mean by area as in finishes.h. Space is divided into cubes of the flakes'
/// size. A hash of the cube's place chooses one of kKinds: one in kEvery has a pair of flakes, the others are plastic
/// alone; so a flash stays where it is while the camera moves. How far pairs lean is spread by GGX's slope
/// distribution. The numbers are by eye.
///
/// Without a place it is the mean of all kinds. Flakes smaller than a pixel are averaged by its samples, not
/// beforehand: they want more samples than plastic.
class Glitter final : public Brdf {
public:
    static constexpr float kFlakes = 0.6f;  ///< s, where there are some
    static constexpr std::size_t kEvery = 5;
    static constexpr float kFlakeAlpha = 0.06f;
    static constexpr float kSpread = 0.35f;     ///< alpha of the slopes
    static constexpr float kFlakeSize = 0.15f;  ///< mm, of `glitter:R,G,B`
    static constexpr float kMinSize = 0.01f, kMaxSize = 10.0f;
    static constexpr std::size_t kKinds = 640;

    /// @param body  reflectance of the plastic, in [0, 1]; flakes are silver with a tint of it
    /// @param size  mm
    explicit Glitter(const Color& body, double size = static_cast<double>(kFlakeSize));
    Color eval(const glm::vec3& wo, const glm::vec3& wi) const override;
    std::optional<BrdfSample> sample(const glm::vec3& wo, float lobe, const glm::vec2& u) const override;
    float pdf(const glm::vec3& wo, const glm::vec3& wi) const override;
    std::shared_ptr<const Brdf> recolored(const Color& body) const override;
    bool variesByPlace() const override { return true; }
    const Brdf& at(const glm::dvec3& place) const override;

private:
    class Spot final : public Brdf {
    public:
        Spot(std::shared_ptr<const Plastic> plastic, const FlakePair& flakes, float share)
            : plastic_(std::move(plastic)), flakes_(flakes), share_(share) {}
        Color eval(const glm::vec3& wo, const glm::vec3& wi) const override;
        std::optional<BrdfSample> sample(const glm::vec3& wo, float lobe, const glm::vec2& u) const override;
        float pdf(const glm::vec3& wo, const glm::vec3& wi) const override;
        Flakes flakes() const override;

    private:
        std::shared_ptr<const Plastic> plastic_;
        FlakePair flakes_;
        float share_;  // of the flakes
    };

    double size_;
    std::shared_ptr<const Plastic> plastic_;
    std::vector<Spot> kinds_;
};

}  // namespace stratum::shade
