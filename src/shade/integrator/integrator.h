// The interface of all integrators, and their construction by name.
#pragma once

#include "shade/camera/sampler.h"
#include "shade/film/film.h"
#include "shade/scene/scene.h"
#include "shade/scene/surface.h"
#include "trace/intersector.h"

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace stratum::shade {

class RadianceCache;
struct RadianceCacheWork;

/// Rays traced against the print. Rays that need no traversal (over the far bed) are not counted, except primary ones:
/// there is one a sample.
struct RayCounts {
    std::uint64_t primary = 0;  ///< from the camera
    std::uint64_t shadow = 0;   ///< to a light, and ambient occlusion's
    std::uint64_t bounce = 0;   ///< drawn from a BRDF
    std::uint64_t total() const { return primary + shadow + bounce; }
    RayCounts& operator+=(const RayCounts& o) {
        primary += o.primary;
        shadow += o.shadow;
        bounce += o.bounce;
        return *this;
    }
    bool operator==(const RayCounts&) const = default;
};

/// Weights of PhongIntegrator's terms.
struct PhongOptions {
    float ambient = 1.0f, diffuse = 1.0f, specular = 1.0f;  ///< ka, kd, ks, each in [0, 100]
    float shininess = 500.0f;                               ///< exponent, in [0, 1e6]
    float reflective = 0.2f;                                ///< kr, weight of the mirror term, in [0, 1]
};

inline constexpr std::array<std::string_view, 11> kIntegratorNames = {
    "path", "direct", "phong", "ao", "normal", "depth", "position", "mask", "layer", "tool", "feature"};

struct IntegratorOptions {
    std::string name = "path";  ///< one of kIntegratorNames
    int bounces = 3;            ///< path: scattering events, 1 to 64. 1 is direct light
    PhongOptions phong;
    double ao_distance = std::numeric_limits<double>::infinity();  ///< ao: world units; farther surfaces don't occlude
    /// path, direct: every path in translucent solids is followed to its end, without a RadianceCache.
    bool exact_translucency = false;
    /// Of makeRadianceCache(). Null: render() makes it where the picture needs one.
    std::shared_ptr<const RadianceCache> radiance_cache;
    /// Keeps what is done of it if the render is put off, for the next one of the same picture. Null: nothing is kept.
    std::shared_ptr<RadianceCacheWork> cache_work;

    /// Throws UsageError.
    void validate() const;
};

/// Whether the integrator of that name evaluates lights; false for those of geometry and ambient occlusion.
bool needsLight(const IntegratorOptions& options);

/// Whether the integrator of that name follows paths of light: path and direct. They alone go inside of translucent
/// solids and make a bed a ShadowCatcher. The others see no bed in a transparent picture.
bool followsPaths(const IntegratorOptions& options);

/// Scattering events of those two: 1 of direct.
int bouncesOf(const IntegratorOptions& options);

/// Immutable; shared by all threads.
class Integrator {
public:
    virtual ~Integrator() = default;
    /// Radiance along camera rays; finite. Each draws from the sampler of its number, in a fixed order, and gets what
    /// it would get alone. All spans are of one length.
    /// @param rays    end at the bed afterwards
    /// @param points  output: the first surface that each ray hits, for the layers of a film; t is infinite if none
    void radianceStream(std::span<trace::Ray> rays, std::span<Sampler> samplers, trace::Tracer& tracer,
                        RayCounts& counts, std::span<SurfacePoint> points, std::span<Pixel> pixels) const;
    virtual FilmContent content() const { return FilmContent::radiance; }

protected:
    Integrator(const SceneDescription& scene, const trace::Intersector& print) : surfaces_(scene, print) {}
    /// The pixel values of camera rays with these first hits (t is infinite if there is none).
    virtual void seenStream(std::span<const trace::Ray> rays, std::span<const SurfacePoint> points,
                            std::span<Sampler> samplers, trace::Tracer& tracer, RayCounts& counts,
                            std::span<Pixel> pixels) const = 0;

    Surfaces surfaces_;
};

/// What one ray needs beside itself.
struct TraceContext {
    trace::Tracer& tracer;
    Sampler& sampler;
    RayCounts& rays;
};

/// Integrators that look at one ray after the other.
class RayIntegrator : public Integrator {
protected:
    using Integrator::Integrator;
    /// The pixel value of a camera ray whose first hit is `first`; null if it hits nothing.
    virtual Pixel seen(const trace::Ray& ray, const SurfacePoint* first, TraceContext& context) const = 0;

private:
    void seenStream(std::span<const trace::Ray> rays, std::span<const SurfacePoint> points, std::span<Sampler> samplers,
                    trace::Tracer& tracer, RayCounts& counts, std::span<Pixel> pixels) const final;
};

/// The integrator of `options`. It keeps references: `scene`, `print` and the radiance cache must outlive it. Throws
/// UsageError.
std::unique_ptr<Integrator> makeIntegrator(const IntegratorOptions& options, const SceneDescription& scene,
                                           const trace::Intersector& print);

}  // namespace stratum::shade
