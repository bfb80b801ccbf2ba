#include "shade/feature.h"

namespace stratum::shade {

Pixel NormalIntegrator::seen(const march::Ray&, const SurfacePoint* first, TraceContext&) const {
    if (first == nullptr) return {};
    const float alpha = 1.0f - surfaces_.fade(*first);
    return {glm::vec3(first->normal) * alpha, alpha};
}

Pixel DepthIntegrator::seen(const march::Ray&, const SurfacePoint* first, TraceContext&) const {
    if (first == nullptr) return {};
    const float alpha = 1.0f - surfaces_.fade(*first);
    // A bed that the camera grazes is almost infinitely far away: 0 times that must be 0.
    return alpha > 0.0f ? Pixel{Color(static_cast<float>(first->t)) * alpha, alpha} : Pixel{};
}

}  // namespace stratum::shade
