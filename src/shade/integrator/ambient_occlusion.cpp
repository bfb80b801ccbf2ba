#include "shade/integrator/ambient_occlusion.h"

#include "shade/camera/ray_streams.h"

#include <cmath>
#include <vector>

namespace stratum::shade {
namespace {

/// The occlusion rays of a stream, of those points that are hit.
struct Stream {
    std::vector<std::size_t> pixels;
    std::vector<glm::vec3> normals;
    std::vector<glm::vec2> draws;
    std::vector<glm::dvec3> directions;
    std::vector<float> fades;
    std::vector<trace::Ray> rays;
    std::vector<std::uint8_t> blocked;
    void resize(std::size_t count) {
        pixels.resize(count);
        normals.resize(count);
        draws.resize(count);
        directions.resize(count);
        fades.resize(count);
        rays.resize(count);
        blocked.resize(count);
    }
};

/// Kept by the thread: fresh memory for every stream would cost as much as tracing it.
Stream& streamOfThread() {
    static thread_local Stream stream;
    return stream;
}

}  // namespace

AmbientOcclusion::AmbientOcclusion(const SceneDescription& scene, const trace::Intersector& print, double distance)
    : Integrator(scene, print), opaque_(scene.backdrop.has_value()), distance_(distance) {}

Pixel AmbientOcclusion::unoccluded(const SurfacePoint* first) const {
    return first != nullptr || opaque_ ? Pixel{Color(1.0f), 1.0f} : Pixel{};
}

void AmbientOcclusion::seenStream(std::span<const trace::Ray> rays, std::span<const SurfacePoint> points,
                                  std::span<Sampler> samplers, trace::Tracer& tracer, RayCounts& counts,
                                  std::span<Pixel> pixels) const {
    Stream& stream = streamOfThread();
    stream.resize(rays.size());
    std::size_t hits = 0;
    for (std::size_t n = 0; n < rays.size(); ++n) {
        const bool meets = std::isfinite(points[n].t);
        pixels[n] = unoccluded(meets ? &points[n] : nullptr);
        stream.pixels[hits] = n;
        stream.normals[hits] = points[n].normal;
        hits += meets ? 1 : 0;
    }
    const std::span draws = std::span(stream.draws).first(hits);
    const std::span directions = std::span(stream.directions).first(hits);
    next2DStream(samplers, std::span(stream.pixels).first(hits), draws);
    cosineDirections(std::span(stream.normals).first(hits), draws, directions);
    std::size_t count = 0;
    for (std::size_t k = 0; k < hits; ++k) {
        const std::size_t pixel = stream.pixels[k];
        surfaces_.leave(points[pixel], directions[k], stream.rays[count]);
        stream.rays[count].t_max = distance_;
        stream.pixels[count] = pixel;  // not past the one that was read
        stream.fades[count] = surfaces_.fade(points[pixel]);
        count += directions[k] != glm::dvec3(0.0) && stream.fades[count] < 1.0f ? 1 : 0;
    }
    counts.shadow += count;
    const std::span blocked = std::span(stream.blocked).first(count);
    surfaces_.occluded(std::span(stream.rays).first(count), tracer, blocked);
    for (std::size_t k = 0; k < count; ++k)
        if (blocked[k] != 0) pixels[stream.pixels[k]].rgb = Color(stream.fades[k]);
}

}  // namespace stratum::shade
