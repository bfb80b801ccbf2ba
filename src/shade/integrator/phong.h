// Phong shading: for comparison with older renderers, and for illustrations.
#pragma once

#include "shade/integrator/integrator.h"
#include "shade/scene/surface.h"

#include <vector>

namespace stratum::shade {

/// Phong's model with hard shadows and mirrors:
///   I = ka Ia + sum over lights of visible Ii [kd max(0, n.l) + ks max(0, r.v)^shininess]
///   color = (1 - kr) base I + kr (what the mirror shows), to a depth of five
/// with base the reflectanceFactor of the surface. Ii is the number given with --light: the intensity of a point light
/// (without distance falloff), the irradiance of a directional one; lights with extent are sampled at their center.
/// Ia is --light ambient. Without any light: Ia = 0.2 and one directional light of 0.8 from above the camera's left
/// shoulder. The bed has no mirror term.
/// Sources: B. T. Phong, CACM 18(6) 1975; the terms, depth and defaults are those of Roukema, "SDFs versus polygons",
/// 2023.
class PhongIntegrator final : public RayIntegrator {
public:
    PhongIntegrator(const SceneDescription& scene, const trace::Intersector& print, const PhongOptions& options);

protected:
    Pixel seen(const trace::Ray& ray, const SurfacePoint* first, TraceContext& context) const override;

private:
    Color local(const SurfacePoint& point, const glm::vec3& view, TraceContext& context) const;

    PhongOptions options_;
    std::vector<std::shared_ptr<const Light>> lights_;
    Color ambient_;
};

}  // namespace stratum::shade
