// Integrators of geometry instead of light: normals, depth, positions, masks and labels, for checks and computer
// vision.
#pragma once

#include "shade/integrator/integrator.h"
#include "shade/scene/surface.h"

namespace stratum::shade {

/// A pixel is what `kSeen` makes of the first hit, null if there is none.
template <FilmContent kContent, Pixel (*kSeen)(const Surfaces& surfaces, const SurfacePoint* first)>
class GeometryIntegrator final : public RayIntegrator {
public:
    GeometryIntegrator(const SceneDescription& scene, const trace::Intersector& print) : RayIntegrator(scene, print) {}
    FilmContent content() const override { return kContent; }

protected:
    Pixel seen(const trace::Ray&, const SurfacePoint* first, TraceContext&) const override {
        return kSeen(surfaces_, first);
    }
};

/// World-space unit normals that face the camera. Alpha is 0 where nothing is hit; the far bed fades out.
Pixel seenNormal(const Surfaces& surfaces, const SurfacePoint* first);
using NormalIntegrator = GeometryIntegrator<FilmContent::normal, seenNormal>;

/// Distance from the eye in world units. Alpha is 0 where nothing is hit; the far bed fades out.
Pixel seenDepth(const Surfaces& surfaces, const SurfacePoint* first);
using DepthIntegrator = GeometryIntegrator<FilmContent::depth, seenDepth>;

/// World-space positions. Alpha is 0 where nothing is hit; the far bed fades out.
Pixel seenPosition(const Surfaces& surfaces, const SurfacePoint* first);
using PositionIntegrator = GeometryIntegrator<FilmContent::position, seenPosition>;

/// 1 on the print, 0 on the bed and where nothing is hit; alpha is the same.
Pixel seenMask(const Surfaces& surfaces, const SurfacePoint* first);
using MaskIntegrator = GeometryIntegrator<FilmContent::unit, seenMask>;

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
