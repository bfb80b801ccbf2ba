// GGX microfacets under a smooth dielectric interface: the pieces of a glossy coat. Local frame, z is the normal.
//
// Sources: B. Walter et al., EGSR 2007 (distribution); E. Heitz, JCGT 3(2) 2014 (height-correlated masking-shadowing);
// E. Heitz, JCGT 7(4) 2018 and J. Dupuy, A. Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023.
#pragma once

#include "shade/camera/sampling.h"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>

namespace stratum::shade {

/// Unpolarized Fresnel reflectance from outside.
/// @param cosine  of the angle of incidence, in [0, 1]
/// @param eta     index of refraction inside / outside, > 1
inline float fresnelDielectric(float cosine, float eta) {
    const float c = std::min(cosine, 1.0f);
    const float t = std::sqrt(1.0f - (1.0f - c * c) / (eta * eta));  // > 0: no total reflection from outside
    const float parallel = (eta * c - t) / (eta * c + t);
    const float perpendicular = (c - eta * t) / (c + eta * t);
    return 0.5f * (parallel * parallel + perpendicular * perpendicular);
}

/// The GGX distribution, along x and across.
///
/// Both roughnesses enter as their product and their ratio, which is 1 where they are equal: the values are then those
/// of the isotropic formulas to the bit.
class Ggx {
public:
    /// @param alpha  in (0, 1]
    explicit Ggx(float alpha) : Ggx(alpha, alpha) {}
    /// @param along, across  alpha along x and along y, in (0, 1]
    Ggx(float along, float across)
        : along_(along), across_(across), product_(along * across), x_(across / along), y_(along / across) {}

    float along() const { return along_; }
    float across() const { return across_; }
    bool isotropic() const { return along_ == across_; }
    float product() const { return product_; }
    float acrossByAlong() const { return x_; }
    float alongByAcross() const { return y_; }

    /// Density of facet normals, per steradian of projected area.
    float d(const glm::vec3& h) const {
        // sin^2 from x and y, not from 1 - z^2, which would lose the digits that a narrow lobe needs.
        const float k = product_ * h.z * h.z + x_ * h.x * h.x + y_ * h.y * h.y;
        return product_ / (kPi * k * k);
    }
    /// Length of a unit direction in the space where the facets are a hemisphere. Masking by it, not by tangents, stays
    /// finite at grazing angles: lambda = (stretch / cosine - 1) / 2.
    float stretch(const glm::vec3& w) const {
        return std::sqrt(w.z * w.z + product_ * (y_ * w.x * w.x + x_ * w.y * w.y));
    }
    /// G2 / (4 cos cos): masking and shadowing with the Jacobian and the projections of a reflection.
    float visibility(const glm::vec3& wo, const glm::vec3& wi) const {
        return 0.5f / (stretch(wo) * wi.z + stretch(wi) * wo.z);
    }
    /// G2 / G1(wo): the weight of a reflection from a visible normal.
    float shadowing(const glm::vec3& wo, const glm::vec3& wi) const {
        return wi.z * (wo.z + stretch(wo)) / (stretch(wo) * wi.z + stretch(wi) * wo.z);
    }

    /// A sample of the facet normals visible from `wo`, wo.z > 0.
    glm::vec3 sampleVisible(const glm::vec3& wo, const glm::vec2& u) const {
        const glm::vec3 stretched = glm::normalize(glm::vec3(wo.x * along_, wo.y * across_, wo.z));
        const float phi = 2.0f * kPi * u.x;
        const float z = (1.0f - u.y) * (1.0f + stretched.z) - stretched.z;
        const float s = std::sqrt(std::clamp(1.0f - z * z, 0.0f, 1.0f));
        const glm::vec3 h = glm::vec3(s * std::cos(phi), s * std::sin(phi), z) + stretched;
        return glm::normalize(glm::vec3(h.x * along_, h.y * across_, std::max(h.z, 0.0f)));
    }
    /// Density, per steradian, of the mirror directions wi = reflect(wo, h) of visible normals.
    float pdfReflected(const glm::vec3& wo, const glm::vec3& h) const { return 0.5f * d(h) / (wo.z + stretch(wo)); }

private:
    float along_, across_;
    float product_;
    float x_, y_;  // across / along, and along / across
};

}  // namespace stratum::shade
