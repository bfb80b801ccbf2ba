// How open a place is: the share of its hemisphere, by cosine, that nothing covers.
#pragma once

#include "shade/integrator/integrator.h"
#include "shade/integrator/surface.h"

#include <optional>

namespace stratum::shade {

/// 1 in the open, 0 in a corner without light. Things farther than `distance` cover nothing. The bed counts.
class AmbientOcclusion final : public Integrator {
public:
    /// @param distance  world units, > 0
    AmbientOcclusion(const SceneDescription& scene, const trace::Intersector& print, double distance);
    FilmContent content() const override { return FilmContent::unit; }

protected:
    Pixel seen(const trace::Ray& ray, const SurfacePoint* first, TraceContext& context) const override;
    /// All occlusion rays of a stream are traced as one.
    void seenStream(std::span<const trace::Ray> rays, std::span<const SurfacePoint> points, std::span<Sampler> samplers,
                    trace::Tracer& tracer, RayCounts& counts, std::span<Pixel> pixels) const override;

private:
    /// The ray that asks whether something covers `first`; none if the answer is known without.
    std::optional<trace::Ray> feeler(const SurfacePoint& first, const glm::vec2& u) const;
    Pixel unoccluded(const SurfacePoint* first) const;

    bool opaque_;  // whether there is a backdrop; it is 1
    double distance_;
};

}  // namespace stratum::shade
