// Ambient occlusion: the cosine-weighted share of the hemisphere over a point that is not occluded.
#pragma once

#include "shade/integrator/integrator.h"
#include "shade/scene/surface.h"

namespace stratum::shade {

/// 1 if nothing is occluded, 0 if everything is. Surfaces farther than `distance` don't occlude. The bed occludes.
class AmbientOcclusion final : public Integrator {
public:
    /// @param distance  world units, > 0
    AmbientOcclusion(const SceneDescription& scene, const trace::Intersector& print, double distance);
    FilmContent content() const override { return FilmContent::unit; }

protected:
    /// All occlusion rays of a stream are traced as one.
    void seenStream(std::span<const trace::Ray> rays, std::span<const SurfacePoint> points, std::span<Sampler> samplers,
                    trace::Tracer& tracer, RayCounts& counts, std::span<Pixel> pixels) const override;

private:
    Pixel unoccluded(const SurfacePoint* first) const;

    bool opaque_;  // whether the scene has a backdrop; its pixels are 1
    double distance_;
};

}  // namespace stratum::shade
