// The interface of all BRDFs.
#pragma once

#include "shade/color.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace stratum::shade {

class Translucent;

/// A direction drawn by Brdf::sample.
struct BrdfSample {
    glm::vec3 wi{0.0f};  ///< towards the light, unit, local frame, wi.z > 0
    Color f{0.0f};       ///< eval(wo, wi), 1/sr, without the cosine
    float pdf = 0.0f;    ///< per steradian, > 0
};

/// Mirror-like flakes of a material, for the guides of the denoiser.
struct Flakes {
    float strength =
        0.0f;  ///< how much brighter than a coat of plastic they mirror, by their share of the area; 0: none
    glm::vec2 slope{0.0f};  ///< by which they lean to both sides, see FlakePair
};

/// A bidirectional reflectance distribution function, in 1/sr.
///
/// Frame: local, z is the surface normal, x and y any tangents; of a material with a direction (undirected()), x is the
/// tangent along it. `wo` points to the viewer, `wi` to the light; both leave the surface and are of unit length. The
/// cosine |wi.z| is never included. Opaque: whenever wo.z or wi.z is not positive, eval and pdf are 0 and sample
/// returns nothing. Contract: reciprocal, eval >= 0 and finite, no albedo above 1, pdf > 0 wherever eval > 0, and
/// sample, eval and pdf agree. Immutable; shared by all threads.
class Brdf {
public:
    virtual ~Brdf() = default;
    virtual Color eval(const glm::vec3& wo, const glm::vec3& wi) const = 0;
    /// @param lobe  uniform in [0, 1): chooses among the lobes
    /// @param u     uniform in [0, 1)^2: chooses the direction in the lobe
    virtual std::optional<BrdfSample> sample(const glm::vec3& wo, float lobe, const glm::vec2& u) const = 0;
    /// Density of sample() per steradian.
    virtual float pdf(const glm::vec3& wo, const glm::vec3& wi) const = 0;
    /// eval() and pdf() of many pairs of directions; faster where there are tables. All spans are of one length.
    virtual void evalStream(std::span<const glm::vec3> wo, std::span<const glm::vec3> wi, std::span<Color> values,
                            std::span<float> densities) const;
    /// sample() for many directions; where there is no sample, its pdf is 0. All spans are of one length.
    virtual void sampleStream(std::span<const glm::vec3> wo, std::span<const float> lobes, std::span<const glm::vec2> u,
                              std::span<BrdfSample> samples) const;
    /// The same with another body color (reflectance in [0, 1]); null for materials without a body color.
    virtual std::shared_ptr<const Brdf> recolored(const Color&) const { return nullptr; }
    /// Itself, if light goes through it; see translucent.h.
    virtual const Translucent* translucent() const { return nullptr; }
    /// Of a material whose gloss has a direction, as printed lines have: the one to use where the direction is not
    /// known. Null for all others. As long-lived as this one.
    virtual const Brdf* undirected() const { return nullptr; }
    /// Whether it is another one at other places; then at() says which.
    virtual bool variesByPlace() const { return false; }
    /// Of this place: mm, in the space of the scene. As long-lived as this one.
    virtual const Brdf& at(const glm::dvec3& /*place*/) const { return *this; }
    /// Those of this place, after at().
    virtual Flakes flakes() const { return {}; }
    /// Notes for reports: the source of a table, and whether it was measured.
    virtual const std::vector<std::string>& notes() const;
};

/// pi f with the viewer above and the light at 45 degrees: the color that a colorimeter (geometry 45/0) reads.
Color reflectanceFactor(const Brdf& brdf);

}  // namespace stratum::shade
