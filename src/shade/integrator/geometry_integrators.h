// Integrators of geometry instead of light: normals, depth, positions, masks and labels, for checks and computer
// vision.
#pragma once

#include "shade/integrator/integrator.h"
#include "shade/scene/surface.h"

namespace stratum::shade {

/// World-space unit normals that face the camera. Alpha is 0 where nothing is hit; the far bed fades out.
class NormalIntegrator final : public RayIntegrator {
public:
    NormalIntegrator(const SceneDescription& scene, const trace::Intersector& print) : RayIntegrator(scene, print) {}
    FilmContent content() const override { return FilmContent::normal; }

protected:
    Pixel seen(const trace::Ray& ray, const SurfacePoint* first, TraceContext& context) const override;
};

/// Distance from the eye in world units. Alpha is 0 where nothing is hit; the far bed fades out.
class DepthIntegrator final : public RayIntegrator {
public:
    DepthIntegrator(const SceneDescription& scene, const trace::Intersector& print) : RayIntegrator(scene, print) {}
    FilmContent content() const override { return FilmContent::depth; }

protected:
    Pixel seen(const trace::Ray& ray, const SurfacePoint* first, TraceContext& context) const override;
};

/// World-space positions. Alpha is 0 where nothing is hit; the far bed fades out.
class PositionIntegrator final : public RayIntegrator {
public:
    PositionIntegrator(const SceneDescription& scene, const trace::Intersector& print) : RayIntegrator(scene, print) {}
    FilmContent content() const override { return FilmContent::position; }

protected:
    Pixel seen(const trace::Ray& ray, const SurfacePoint* first, TraceContext& context) const override;
};

/// 1 on the print, 0 on the bed and where nothing is hit; alpha is the same.
class MaskIntegrator final : public RayIntegrator {
public:
    MaskIntegrator(const SceneDescription& scene, const trace::Intersector& print) : RayIntegrator(scene, print) {}
    FilmContent content() const override { return FilmContent::unit; }

protected:
    Pixel seen(const trace::Ray& ray, const SurfacePoint* first, TraceContext& context) const override;
};

/// A label (layer, tool or feature), each number in a flat color (categoryColor). The bed and surfaces without the
/// label are black; alpha is 1 on the print. Aov has the numbers themselves. scene.labels must have the label.
class LabelIntegrator final : public RayIntegrator {
public:
    LabelIntegrator(const SceneDescription& scene, const trace::Intersector& print, Label label)
        : RayIntegrator(scene, print), label_(label) {}
    FilmContent content() const override { return FilmContent::unit; }

protected:
    Pixel seen(const trace::Ray& ray, const SurfacePoint* first, TraceContext& context) const override;

private:
    Label label_;
};

}  // namespace stratum::shade
