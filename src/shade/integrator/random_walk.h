// Light inside of a translucent solid: free flights and scattering events, until the surface is met again.
#pragma once

#include "shade/brdf/translucent.h"
#include "shade/camera/sampler.h"
#include "shade/integrator/integrator.h"
#include "shade/scene/surface.h"
#include "trace/intersector.h"

#include <cstddef>
#include <span>
#include <vector>

namespace stratum::shade {

/// What a path carries from surface to surface.
struct PathState {
    Color throughput{1.0f};
    std::size_t pixel = 0;  ///< index of its sampler and of its sum
    int scatterings = 0;    ///< at opaque surfaces
    int crossings = 0;      ///< surfaces of translucent solids that it has met, from either side
    bool ambient = false;   ///< has had SceneDescription::ambient
};

/// A path inside of a solid.
struct Walker : PathState {
    Walker() = default;
    Walker(const PathState& state, const trace::Ray& along, const Translucent* inside)
        : PathState(state), ray(along), solid(inside) {}
    trace::Ray ray;  ///< from the surface, or from the last event, inwards
    const Translucent* solid = nullptr;
};

/// A walker that has met a surface: of the solid from inside, of the bed, of something in the solid.
struct Arrival {
    Walker walker;
    SurfacePoint point;
};

/// Free flights are drawn from exp(-t / mean free path), so that an event's weight is its albedo; the direction of an
/// event from Henyey's and Greenstein's phase function. Faint walkers end by Russian roulette. Unbiased.
/// All walkers of a call advance together, one flight a step, so that rays are traced as streams; each one's result
/// depends on its own ray and sampler alone. Immutable; shared by all threads.
class RandomWalk {
public:
    /// @param surfaces  must outlive it
    /// @param bounds    of the prints: who is outside went through a hole of the surface, and ends
    RandomWalk(const Surfaces& surfaces, const trace::Box& bounds, double mm_per_unit)
        : surfaces_(surfaces), bounds_(bounds), mm_per_unit_(mm_per_unit) {}

    /// Empties `walkers`; replaces `arrivals`, of those that were not absorbed.
    void walk(std::vector<Walker>& walkers, std::span<Sampler> samplers, trace::Tracer& tracer, RayCounts& counts,
              std::vector<Arrival>& arrivals) const;

private:
    /// Whether it goes on.
    bool scatter(Walker& walker, Sampler& sampler) const;

    const Surfaces& surfaces_;
    trace::Box bounds_;
    double mm_per_unit_;
};

/// A direction about `before` (unit) by Henyey's and Greenstein's phase function.
/// Source: L. Henyey, J. Greenstein, Astrophysical Journal 93, 1941; its inverse as in Witt, ApJS 35, 1977.
glm::dvec3 scatteredDirection(const glm::dvec3& before, float asymmetry, const glm::vec2& u);

/// Russian roulette. Draws only for a faint path, and makes it brighter if it goes on.
bool survives(Color& throughput, Sampler& sampler);

}  // namespace stratum::shade
