// Path tracing from the camera, with next event estimation and multiple importance sampling.
#pragma once

#include "shade/brdf/brdf_batch.h"
#include "shade/environment/environment.h"
#include "shade/frame.h"
#include "shade/integrator/integrator.h"
#include "shade/integrator/radiance_cache.h"
#include "shade/integrator/random_walk.h"
#include "shade/scene/surface.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace stratum::shade {

/// Path tracing with `bounces` scattering events. At each of them the environment is sampled by its own density and by
/// the BRDF's, combined by multiple importance sampling; on the bed its makeBedSampler() takes the place of
/// that density. Every light is sampled at every vertex; lights with extent also by the BRDF. Ambient light is added
/// once a path, where it first goes on through the air. Unbiased for paths of that length; nothing is clamped.
///
/// Translucent solids let a path in at their rough surface; it walks inside (RandomWalk) until it meets the surface
/// from there, is reflected inwards, or leaves. Such events do not count as bounces: the path ends by Russian roulette,
/// or at the opaque surface that would be one too many. Lights are sampled from both sides of the surface, not from
/// inside, where every ray would be refracted. A scene without such solids does nothing of this.
/// With a RadianceCache a path ends at the fifth such surface that it meets, the third after an opaque one, with what
/// the cache knows of such paths.
///
/// All paths of a stream advance together by one vertex a step, so that rays of one kind are traced as a stream: first
/// the shadow rays of a step, then the rays drawn from the BRDFs. The result of a path depends on its own ray and
/// sampler alone.
class PathIntegrator final : public Integrator {
public:
    /// @param cache  null: every path is followed to its end; else it must outlive the integrator
    PathIntegrator(const SceneDescription& scene, const trace::Intersector& print, int bounces,
                   const RadianceCache* cache = nullptr);

    /// Follows camera rays with these first hits to their ends, and lists the vertices that the cache would answer for.
    void followDeep(std::span<const trace::Ray> rays, std::span<const SurfacePoint> points, std::span<Sampler> samplers,
                    trace::Tracer& tracer, std::vector<DeepVertex>& vertices) const;

protected:
    void seenStream(std::span<const trace::Ray> rays, std::span<const SurfacePoint> points, std::span<Sampler> samplers,
                    trace::Tracer& tracer, RayCounts& counts, std::span<Pixel> pixels) const override;

private:
    /// A path up to its current vertex.
    struct Path : PathState {
        Path(const PathState& state, const SurfacePoint& at, const glm::dvec3& along)
            : PathState(state), point(at), direction(along) {}
        SurfacePoint point;
        glm::dvec3 direction;                 // of the ray that met the point
        const Translucent* solid = nullptr;   // of the point; null if it is opaque
        const Translucent* inside = nullptr;  // where the ray came through; null for air
        Side side() const { return point.from_inside ? Side::solid : Side::air; }
    };
    /// What the paths of a stream share.
    struct Stream {
        std::span<Sampler> samplers;
        std::span<Color> sums;
        std::span<Color> bare;          // empty where nobody asks for it
        std::vector<DeepVertex>* deep;  // lists vertices for the cache; null: the cache is read
    };
    /// Rays, and the light that each adds to its pixel if it is unoccluded.
    struct ShadowRays {
        std::vector<trace::Ray> rays;
        std::vector<Color> light;  // times the throughput of the path
        std::vector<std::size_t> pixel;
        /// Adds a ray and returns it, to be set where it stays.
        trace::Ray& add(const Color& value, std::size_t to);
        void reserve(std::size_t count);
        void clear();
    };
    /// The current vertex of a path, with its shading frame.
    struct PathVertex {
        explicit PathVertex(Path& of);
        /// A direction mirrored at the real surface.
        glm::vec3 mirrored(const glm::vec3& direction) const;
        /// Of a bent vertex: the density of a direction into the air, which is its value times the cosine, too.
        float bentPdf(const glm::vec3& direction) const;
        Path* path;
        Frame frame;
        glm::vec3 wo;  // unit, in `frame`, towards the previous vertex; z of the side that it is on (RoughInterface)
        /// On a translucent solid whose smooth normal is not that of the real surface. What is drawn to one side by the
        /// smooth normal and lies on the other by the real one is mirrored, so that no light is lost.
        bool bent;
    };
    /// A ray drawn from the BRDF.
    struct Bounce {
        const PathVertex* from = nullptr;
        trace::Ray ray;
        glm::vec3 direction{0.0f};  // of ray
        float pdf = 0.0f;
        Color escaped{0.0f};                  // radiance along it if it hits nothing, weighted by MIS
        const Translucent* inside = nullptr;  // it goes through; null for air
    };
    /// Vertices or bounces whose light is drawn by one sampler: on the bed the bed's, else the environment.
    struct Group {
        const EnvironmentSampler* light;   // null without a bed, where it has no members
        float share;                       // factor of the BRDF's pdf in the balance heuristic
        std::vector<std::size_t> members;  // indices
    };
    /// The bed without the print, where it is the same everywhere: neither lamps nor bumps.
    struct BareBed {
        Color radiance{0.0f};  ///< of a white one
        trace::Box print;      ///< bounds
        /// Share of the light at a place on the bed that the print leaves, roughly: half of what the cosine gives to
        /// directions below its top counts as taken. The best factor of the control variate is near to that.
        float share(const glm::dvec3& place) const;
    };
    /// Samples of light for a group: the input and output of one call of sampleStream or evalStream.
    struct LightBatch {
        std::vector<std::size_t> pixels;  // indices of the samplers
        std::vector<glm::vec2> u;
        std::vector<glm::vec3> directions, normals;
        std::vector<EnvironmentSample> samples;
        std::vector<std::size_t> lit;  // those that light comes from
        BrdfBatch reflections;         // of those; of scatterAll, of all vertices
        void resize(std::size_t count);
    };

    /// Adds a path at its next surface, unless that is an opaque one too many, or the cache knows what it would bring.
    /// Of a translucent solid the normals are made to point to the air.
    void addPath(const PathState& state, const SurfacePoint& point, const glm::dvec3& direction,
                 const Translucent* inside, const Stream& stream, std::vector<Path>& paths) const;
    /// Adds what the cache knows of a path at a translucent surface to its sum; false if it must be followed.
    bool endDeep(const PathState& state, const SurfacePoint& point, const glm::dvec3& direction,
                 const Stream& stream) const;
    /// All paths of a stream, to their ends.
    void follow(std::span<const trace::Ray> rays, std::span<const SurfacePoint> points, const Stream& stream,
                trace::Tracer& tracer, RayCounts& counts) const;
    void sampleEnvironment(const Group& group, std::span<const PathVertex> vertices, std::span<Sampler> samplers,
                           ShadowRays& shadow_rays, LightBatch& batch) const;
    /// Adds one shadow ray for each light.
    void sampleLights(const PathVertex& vertex, Sampler& sampler, ShadowRays& shadow_rays) const;
    /// Goes on in a direction drawn from the BRDF and updates the path's throughput; false if the path ends.
    bool scatter(PathVertex& vertex, const BrdfSample& next, Bounce& bounce) const;
    /// The same at the surface of a translucent solid, which draws it.
    bool scatterThrough(PathVertex& vertex, const glm::vec2& lobe_draw, const glm::vec2& draw, Bounce& bounce) const;
    /// Bounces in air, and walkers inside of solids, of all paths that go on.
    void scatterAll(std::span<PathVertex> vertices, std::span<const glm::vec2> lobe_draws,
                    std::span<const glm::vec2> brdf_draws, std::span<Color> sums, std::vector<Bounce>& bounces,
                    std::vector<Walker>& walkers, BrdfBatch& batch) const;
    /// Walks on inside of solids, and lists the paths that go on from where they meet a surface.
    void walk(std::vector<Walker>& walkers, const Stream& stream, trace::Tracer& tracer, RayCounts& counts,
              std::vector<Path>& next_paths) const;
    /// Adds the environment's radiance to Bounce::escaped.
    void evalEscaped(const Group& group, std::span<Bounce> bounces, LightBatch& batch) const;
    /// MIS-weighted radiance of the lights with extent that a ray drawn from the BRDF hits up to the distance t.
    Color hitLights(const trace::Ray& ray, double t, float pdf) const;
    /// Traces the rays and adds the light of those that are unoccluded to the sums of their pixels. Overwrites the
    /// rays.
    void addUnoccluded(ShadowRays& shadow_rays, trace::Tracer& tracer, std::span<Color> sums) const;
    /// Adds the light that the bounces hit or escape to, and lists the paths that go on from their hits.
    void continuePaths(std::span<const Bounce> bounces, std::span<const SurfacePoint> hits, const Stream& stream,
                       std::vector<Path>& next_paths) const;
    /// Adds what the first vertices would receive if nothing were in the way, in the order in which light is added to
    /// the sums: without a shadow the two are equal to the last bit.
    void addBare(std::span<const SurfacePoint> points, const ShadowRays& shadow_rays, std::span<const Bounce> bounces,
                 std::span<Color> bare) const;
    /// Where the bed is seen: takes the noise out of the light that it would have without the print, which is known. A
    /// control variate: unbiased; far from the print nothing is left to be sampled.
    void reduceBedNoise(std::span<const SurfacePoint> points, std::span<const Color> bare, std::span<Color> sums) const;
    /// The pixels of a transparent picture, see ShadowCatcher.
    void catchShadows(std::span<const SurfacePoint> points, std::span<const Color> sums, std::span<const Color> bare,
                      std::span<Pixel> pixels) const;
    /// Shadow rays of a vertex at most.
    std::size_t raysAVertex() const;
    /// Share of the backdrop in what a camera ray sees.
    float fadeAt(const SurfacePoint& point) const;
    void blendBackdrop(std::span<const trace::Ray> rays, std::span<const SurfacePoint> points,
                       std::span<const Color> sums, std::span<Pixel> pixels) const;

    const SceneDescription& scene_;
    std::unique_ptr<const EnvironmentSampler> bed_sampler_;
    std::optional<BareBed> bare_bed_;
    int bounces_;
    const RadianceCache* cache_;
    std::optional<RandomWalk> walk_;             // only where something is translucent
    std::vector<const Light*> extended_lights_;  // of the scene, see Light::hasExtent
};

}  // namespace stratum::shade
