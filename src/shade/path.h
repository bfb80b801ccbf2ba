// Light as it travels: paths from the camera, joined to the lights at every bounce.
#pragma once

#include "shade/bed_light.h"
#include "shade/frame.h"
#include "shade/integrator.h"
#include "shade/surface.h"

#include <memory>
#include <vector>

namespace stratum::shade {

/// Path tracing. At each of `bounces` scattering events on the print the environment is sampled both by its own density
/// and by the BRDF's, joined by multiple importance sampling; on the bed by BedLight first of all. Lamps are summed;
/// those with extent are sampled in both ways, too. Unbiased for paths of that length; nothing is clamped.
class PathIntegrator final : public Integrator {
public:
    PathIntegrator(const SceneDescription& scene, const march::Intersector& print, int bounces);

protected:
    Pixel seen(const march::Ray& ray, const SurfacePoint* first, TraceContext& context) const override;

private:
    Color fromEnvironment(const SurfacePoint& point, const Frame& frame, const glm::vec3& wo,
                          TraceContext& context) const;
    Color fromLights(const SurfacePoint& point, const Frame& frame, const glm::vec3& wo, TraceContext& context) const;
    /// What the lamps with extent add to a ray drawn from the BRDF that goes on freely up to t.
    Color fromLamps(const march::Ray& ray, double t, float pdf) const;
    Color scattered(SurfacePoint point, glm::dvec3 direction, TraceContext& context) const;

    const SceneDescription& scene_;
    std::unique_ptr<const BedLight> bed_light_;
    int bounces_;
    std::vector<const Light*> lamps_;  // those with extent
};

}  // namespace stratum::shade
