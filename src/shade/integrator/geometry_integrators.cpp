#include "shade/integrator/geometry_integrators.h"

#include <algorithm>

namespace stratum::shade {
namespace {

// Files state labels as they like; larger numbers do not fit into integers.
constexpr float kMostLabel = 1e9f;

}  // namespace

Pixel seenNormal(const Surfaces& surfaces, const SurfacePoint* first) {
    if (first == nullptr) return {};
    const float alpha = 1.0f - surfaces.fade(*first);
    return {glm::vec3(first->normal) * alpha, alpha};
}

Pixel seenDepth(const Surfaces& surfaces, const SurfacePoint* first) {
    if (first == nullptr) return {};
    const float alpha = 1.0f - surfaces.fade(*first);
    // At grazing angles the distance to the bed can overflow: 0 times that must be 0.
    return alpha > 0.0f ? Pixel{Color(static_cast<float>(first->t)) * alpha, alpha} : Pixel{};
}

Pixel seenPosition(const Surfaces& surfaces, const SurfacePoint* first) {
    if (first == nullptr) return {};
    const float alpha = 1.0f - surfaces.fade(*first);
    return {alpha * Color(first->position), alpha};
}

Pixel seenMask(const Surfaces&, const SurfacePoint* first) {
    if (first == nullptr || first->bed) return {};
    return {Color(1.0f), 1.0f};
}

Pixel LabelIntegrator::seen(const trace::Ray&, const SurfacePoint* first, TraceContext&) const {
    if (first == nullptr || first->bed) return {};
    const float value = first->labels[static_cast<std::size_t>(label_)];
    return {value >= 0.0f ? categoryColor(static_cast<std::size_t>(std::min(value, kMostLabel))) : Color(0.0f), 1.0f};
}

}  // namespace stratum::shade
