// Everything that a ray can meet: the print and the bed.
#pragma once

#include "march/intersector.h"
#include "shade/brdf.h"
#include "shade/lambert.h"
#include "shade/scene.h"

#include <glm/vec3.hpp>

namespace stratum::shade {

/// A point where light is scattered. World space.
struct SurfacePoint {
    glm::dvec3 position{0.0};
    glm::dvec3 normal{0.0, 0.0, 1.0};  ///< unit, geometric, on the side that the ray came from
    double t = 0.0;                    ///< along the ray, world units
    const Brdf* brdf = nullptr;
    bool bed = false;
};

/// Immutable; shared by all threads. Keeps references to the scene and its material.
class Surfaces {
public:
    Surfaces(const SceneDescription& scene, const march::Intersector& print);

    /// The nearest surface in the ray's interval; false if there is none.
    bool nearest(const march::Ray& ray, march::Tracer& tracer, SurfacePoint& point) const;
    bool occluded(const march::Ray& ray, march::Tracer& tracer) const;
    /// A ray that leaves a point without meeting the same surface again.
    /// @param direction  world space, near unit length
    march::Ray leave(const SurfacePoint& point, const glm::vec3& direction) const;
    /// Share of the backdrop in what the camera sees of this point, 0 to 1.
    float fade(const SurfacePoint& point) const;
    /// What the camera sees where there is nothing.
    bool backdrop(const march::Ray& ray, Color& radiance) const;

private:
    const SceneDescription& scene_;
    double offset_;  // world units
    Lambert paper_;
};

}  // namespace stratum::shade
