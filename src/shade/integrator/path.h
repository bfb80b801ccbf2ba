// Light as it travels: paths from the camera, joined to the lights at every bounce.
#pragma once

#include "shade/environment/bed_light.h"
#include "shade/frame.h"
#include "shade/integrator/integrator.h"
#include "shade/integrator/surface.h"

#include <memory>
#include <vector>

namespace stratum::shade {

/// Path tracing. At each of `bounces` scattering events on the print the environment is sampled both by its own density
/// and by the BRDF's, joined by multiple importance sampling; on the bed by BedLight first of all. Lamps are summed;
/// those with extent are sampled in both ways, too. Unbiased for paths of that length; nothing is clamped.
///
/// All paths of a stream take each step together, so that rays of one kind are traced as a stream: first the shadow
/// rays of a bounce, then the rays that go on. A path's result depends on its own ray and sampler alone.
class PathIntegrator final : public Integrator {
public:
    PathIntegrator(const SceneDescription& scene, const trace::Intersector& print, int bounces);

protected:
    /// A stream of one.
    Pixel seen(const trace::Ray& ray, const SurfacePoint* first, TraceContext& context) const override;
    void seenStream(std::span<const trace::Ray> rays, std::span<const SurfacePoint> points, std::span<Sampler> samplers,
                    trace::Tracer& tracer, RayCounts& counts, std::span<Pixel> pixels) const override;

private:
    /// A path on its way. It stands on a surface.
    struct Path {
        SurfacePoint point;
        glm::dvec3 direction;  // of the ray that met the point
        Color throughput{1.0f};
        std::size_t pixel = 0;
    };
    /// Rays that bring light home unless something stands in their way.
    struct Feelers {
        std::vector<trace::Ray> rays;
        std::vector<Color> light;  // premultiplied by the throughput
        std::vector<std::size_t> pixel;
        void add(const trace::Ray& ray, const Color& value, std::size_t to);
        void clear();
    };
    /// A path in the frame of the surface that it stands on.
    struct Stand {
        Path* path;
        Frame frame;
        glm::vec3 wo;  // local, back along the path
    };
    /// A ray drawn from the BRDF, and what it brings home if it meets nothing.
    struct Bounce {
        const Stand* from;
        trace::Ray ray;
        glm::vec3 way;  // its direction
        float pdf;
        Color escaped;
    };
    /// What is lit in one way: by BedLight, or by the environment.
    struct Group {
        bool bed;
        std::vector<std::size_t> members;
    };
    /// Samples of light for a group.
    struct Looks {
        std::vector<std::size_t> pixels;  // whose samplers draw
        std::vector<glm::vec2> u;
        std::vector<glm::vec3> ways, normals;
        std::vector<EnvironmentSample> samples;
        void resize(std::size_t count);
    };

    void feelEnvironment(const Group& group, std::span<const Stand> stands, std::span<Sampler> samplers,
                         Feelers& feelers, Looks& looks) const;
    void feelLights(const Stand& stand, Sampler& sampler, Feelers& feelers) const;
    /// Scatters a path: nothing if it ends. Changes its throughput.
    std::optional<Bounce> scatter(Stand& stand, float lobe_draw, const glm::vec2& brdf_draw) const;
    void lookWhereTheyGo(const Group& group, std::span<Bounce> bounces, Looks& looks) const;
    /// What the lamps with extent add to a ray drawn from the BRDF that goes on freely up to t.
    Color fromLamps(const trace::Ray& ray, double t, float pdf) const;
    void gather(const Feelers& feelers, trace::Tracer& tracer, std::span<Color> sums) const;

    const SceneDescription& scene_;
    std::unique_ptr<const BedLight> bed_light_;
    int bounces_;
    std::vector<const Light*> lamps_;  // those with extent
};

}  // namespace stratum::shade
