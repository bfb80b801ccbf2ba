// Direct light of the environment as a sum over the cells of a coarse map: a simple method, for comparison.
#pragma once

#include "shade/integrator/integrator.h"
#include "shade/integrator/surface.h"

#include <vector>

namespace stratum::shade {

/// The environment is averaged over `rows` x 2 `rows` cells of a latitude-longitude map. At each point that the camera
/// sees, the cells above the surface are added, each with one shadow ray to its center, weighted by the BRDF, its solid
/// angle and the cosine; lights with extent are sampled at their center. One bounce. Free of noise, but biased: shadows
/// are those of a few hundred hard lights, and highlights narrower than a cell are lost. Source: J. Spilar,
/// "Visualization of 3D printing via ray tracing", CTU Prague 2025.
class EnvironmentSum final : public Integrator {
public:
    EnvironmentSum(const SceneDescription& scene, const trace::Intersector& print, int rows);

protected:
    Pixel seen(const trace::Ray& ray, const SurfacePoint* first, TraceContext& context) const override;

private:
    struct Cell {
        glm::vec3 direction;
        Color power;  // radiance times solid angle
    };
    const SceneDescription& scene_;
    std::vector<Cell> cells_;
};

}  // namespace stratum::shade
