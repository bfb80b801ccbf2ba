// What the geometry is, not what it looks like: normals and depth, for checking and for computer vision.
#pragma once

#include "shade/integrator/integrator.h"
#include "shade/integrator/surface.h"

namespace stratum::shade {

/// World-space unit normals, on the side that is seen. Alpha 0 where there is nothing; the far bed fades out.
class NormalIntegrator final : public Integrator {
public:
    NormalIntegrator(const SceneDescription& scene, const trace::Intersector& print) : Integrator(scene, print) {}
    FilmContent content() const override { return FilmContent::normal; }

protected:
    Pixel seen(const trace::Ray& ray, const SurfacePoint* first, TraceContext& context) const override;
};

/// Distance from the eye in world units. Alpha 0 where there is nothing; the far bed fades out.
class DepthIntegrator final : public Integrator {
public:
    DepthIntegrator(const SceneDescription& scene, const trace::Intersector& print) : Integrator(scene, print) {}
    FilmContent content() const override { return FilmContent::depth; }

protected:
    Pixel seen(const trace::Ray& ray, const SurfacePoint* first, TraceContext& context) const override;
};

/// World-space positions. Alpha 0 where there is nothing; the far bed fades out.
class PositionIntegrator final : public Integrator {
public:
    PositionIntegrator(const SceneDescription& scene, const trace::Intersector& print) : Integrator(scene, print) {}
    FilmContent content() const override { return FilmContent::position; }

protected:
    Pixel seen(const trace::Ray& ray, const SurfacePoint* first, TraceContext& context) const override;
};

/// 1 on the print, 0 on the bed and beside both; alpha is the same.
class MaskIntegrator final : public Integrator {
public:
    MaskIntegrator(const SceneDescription& scene, const trace::Intersector& print) : Integrator(scene, print) {}
    FilmContent content() const override { return FilmContent::unit; }

protected:
    Pixel seen(const trace::Ray& ray, const SurfacePoint* first, TraceContext& context) const override;
};

/// What was printed, each number in a flat colour (categoryColor), the bed and what doesn't know are black; alpha is 1
/// on the print. Numbers themselves are layers beside a picture, see Aov. scene.labels must have the label.
class LabelIntegrator final : public Integrator {
public:
    LabelIntegrator(const SceneDescription& scene, const trace::Intersector& print, Label label)
        : Integrator(scene, print), label_(label) {}
    FilmContent content() const override { return FilmContent::unit; }

protected:
    Pixel seen(const trace::Ray& ray, const SurfacePoint* first, TraceContext& context) const override;

private:
    Label label_;
};

}  // namespace stratum::shade
