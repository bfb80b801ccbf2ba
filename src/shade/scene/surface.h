// Everything that a ray can hit: the print and the bed.
#pragma once

#include "shade/brdf/brdf.h"
#include "shade/scene/scene.h"
#include "trace/intersector.h"

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace stratum::shade {

/// A point where light is scattered. World space.
struct SurfacePoint {
    glm::dvec3 position{0.0};
    glm::dvec3 normal{0.0, 0.0, 1.0};     ///< unit, for shading, on the side of the ray's origin
    glm::dvec3 geometric{0.0, 0.0, 1.0};  ///< unit, to offset new rays along; differs only with smooth normals
    glm::vec3 grain{0.0f};                ///< Tracer::grain(), where the material has a direction; else zero
    double t = 0.0;                       ///< along the ray, world units
    const Brdf* brdf = nullptr;
    Color albedo{0.0f};  ///< reflectanceFactor of brdf
    bool bed = false;
    bool from_inside = false;  ///< the ray came through the solid; set for prints
    /// By Label: values at this point; -1 if the scene doesn't request the label or the object doesn't have it.
    std::array<float, kLabels> labels{-1.0f, -1.0f, -1.0f};
};

/// Immutable; shared by all threads. Keeps references to the scene and its material.
class Surfaces {
public:
    Surfaces(const SceneDescription& scene, const trace::Intersector& print);

    /// The nearest surface in the ray's interval; false if there is none.
    bool nearest(const trace::Ray& ray, trace::Tracer& tracer, SurfacePoint& point) const;
    /// The same for many rays; points[i].t is infinite where there is none. `points` is as long as `rays`, which end
    /// at the bed afterwards.
    void nearest(std::span<trace::Ray> rays, trace::Tracer& tracer, std::span<SurfacePoint> points) const;
    /// The same for rays that were scattered. They meet gloss without its direction (Brdf::undirected()): to look up
    /// the beads where such rays end would take longer than the rays.
    void nearestBounced(std::span<trace::Ray> rays, trace::Tracer& tracer, std::span<SurfacePoint> points) const;
    /// The same for rays inside of a translucent print. What stands on the bed touches it without a gap: a bottom less
    /// than a twentieth of a voxel above the bed is the bed.
    void nearestInside(std::span<trace::Ray> rays, trace::Tracer& tracer, std::span<SurfacePoint> points) const;
    bool occluded(const trace::Ray& ray, trace::Tracer& tracer) const;
    /// blocked[i] is 1 or 0. `blocked` is as long as `rays`, which are overwritten.
    void occluded(std::span<trace::Ray> rays, trace::Tracer& tracer, std::span<std::uint8_t> blocked) const;
    /// A ray from a point, offset so that it doesn't hit the same surface again.
    /// @param direction  world space, near unit length
    trace::Ray leave(const SurfacePoint& point, const glm::vec3& direction) const {
        trace::Ray ray;
        leave(point, direction, ray);
        return ray;
    }
    /// The same where the ray stays: what is copied in one piece waits for the pieces that it was made of.
    void leave(const SurfacePoint& point, const glm::vec3& direction, trace::Ray& ray) const {
        leave(point, glm::normalize(glm::dvec3(direction)), ray);
    }
    /// @param unit  of length 1 to the last bits
    void leave(const SurfacePoint& point, const glm::dvec3& unit, trace::Ray& ray) const {
        for (int axis = 0; axis < 3; ++axis) {
            ray.origin[axis] = point.position[axis] + offset_ * point.geometric[axis];
            ray.direction[axis] = unit[axis];
        }
        ray.t_min = 0.0;
        ray.t_max = trace::kInfinity;
    }
    /// The same into the solid behind it.
    trace::Ray enter(const SurfacePoint& point, const glm::vec3& direction) const {
        return {point.position - offset_ * point.geometric, glm::normalize(glm::dvec3(direction))};
    }
    /// Share of the backdrop in what the camera sees of this point, 0 to 1.
    float fade(const SurfacePoint& point) const;
    /// Radiance that the camera sees along a ray that hits nothing; false if there is no backdrop.
    bool backdrop(const trace::Ray& ray, Color& radiance) const;
    /// The same for many rays. `radiances` is as long as `rays`.
    bool backdrop(std::span<const trace::Ray> rays, std::span<Color> radiances) const;

private:
    enum class Gloss : std::uint8_t { directed, undirected };
    // They set every field, where it stays: to copy what was just written in pieces takes longer than to write it.
    void onPrint(const trace::Ray& ray, const trace::Hit& hit, Gloss gloss, trace::Tracer& tracer,
                 SurfacePoint& point) const;
    static void onBed(const Bed& bed, const trace::Ray& ray, double t, SurfacePoint& point);
    void nearest(std::span<trace::Ray> rays, const Bed* bed, Gloss gloss, trace::Tracer& tracer,
                 std::span<SurfacePoint> points) const;

    const SceneDescription& scene_;
    double offset_;               // world units
    ObjectMaterial only_;         // of objects that scene_.objects doesn't have
    std::optional<Bed> contact_;  // the bed for rays inside, a little higher
};

}  // namespace stratum::shade
