// How open a place is: the share of its hemisphere, by cosine, that nothing covers.
#pragma once

#include "shade/integrator.h"
#include "shade/surface.h"

namespace stratum::shade {

/// 1 in the open, 0 in a corner without light. Things farther than `distance` cover nothing. The bed counts.
class AmbientOcclusion final : public Integrator {
public:
    /// @param distance  world units, > 0
    AmbientOcclusion(const SceneDescription& scene, const march::Intersector& print, double distance);
    Pixel radiance(const march::Ray& ray, TraceContext& context) const override;
    FilmContent content() const override { return FilmContent::unit; }

private:
    Surfaces surfaces_;
    bool opaque_;  // whether there is a backdrop; it is 1
    double distance_;
};

}  // namespace stratum::shade
