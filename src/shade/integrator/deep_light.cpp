#include "shade/integrator/deep_light.h"

#include "base/parallel_for.h"
#include "base/stopwatch.h"
#include "shade/camera/ray_streams.h"
#include "shade/integrator/path.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <vector>

namespace stratum::shade {
namespace {

constexpr std::size_t kPaths = 1024;    // paths at a time: enough to fill vectors
constexpr std::size_t kMostRounds = 8;  // of camera rays for one stream, most of which may miss the print
constexpr std::uint32_t kSeed = 0xdee9u;

/// The paths of one stream: what the camera sees of translucent prints.
class DeepStream {
public:
    DeepStream(const SceneDescription& scene, const Surfaces& surfaces) : scene_(scene), surfaces_(surfaces) {}

    /// Returns the number of paths.
    std::size_t follow(const PathIntegrator& integrator, std::size_t number, trace::Tracer& tracer,
                       std::vector<DeepVertex>& vertices) {
        rays_.clear();
        samplers_.clear();
        points_.clear();
        for (std::size_t round = 0; round < kMostRounds && rays_.size() < kPaths; ++round)
            look(number * kMostRounds + round, tracer);
        integrator.followDeep(rays_, points_, samplers_, tracer, vertices);
        return rays_.size();
    }

private:
    void look(std::size_t round, trace::Tracer& tracer) {
        std::vector<trace::Ray> rays(kPaths);
        std::vector<Sampler> samplers(kPaths, Sampler(kSeed, 65536));
        std::vector<SurfacePoint> points(kPaths);
        for (std::size_t n = 0; n < kPaths; ++n) {
            samplers[n].start(0, 0, static_cast<std::uint32_t>(round * kPaths + n));
            rays[n] = anyPrimaryRay(scene_.camera, samplers[n]);
        }
        surfaces_.nearest(rays, tracer, points);
        for (std::size_t n = 0; n < kPaths && rays_.size() < kPaths; ++n) {
            if (!std::isfinite(points[n].t) || points[n].brdf->translucent() == nullptr) continue;
            rays_.push_back(rays[n]);
            samplers_.push_back(samplers[n]);
            points_.push_back(points[n]);
        }
    }

    const SceneDescription& scene_;
    const Surfaces& surfaces_;
    std::vector<trace::Ray> rays_;
    std::vector<Sampler> samplers_;
    std::vector<SurfacePoint> points_;
};

/// With so many paths, cells are as small as they get; more make their means better.
constexpr double kEnough = 65536.0;

/// As many cells as paths can tell of.
int cellsFor(double paths) {
    constexpr double kMostCells = 32.0;  // along the longest side; with 64 pictures were no better
    return static_cast<int>(std::lround(kMostCells * std::cbrt(std::min(paths / kEnough, 1.0))));
}

std::size_t streamsFor(const RenderOptions& options) {
    constexpr double kMost = 262144.0, kUsualSpp = 32.0;
    // How many samples a picture takes that is made to an error or by the clock is not known before.
    const double spp = options.noise > 0.0 || options.seconds > 0.0 ? kUsualSpp : options.spp;
    const double samples = spp * options.width * options.height;
    const double paths = std::max(std::min(samples / 16.0, kEnough), std::min(samples / 32.0, kMost));
    return std::max(std::size_t{1}, static_cast<std::size_t>(paths) / kPaths);
}

}  // namespace

std::shared_ptr<const RadianceCache> makeRadianceCache(const SceneDescription& scene, const trace::Intersector& print,
                                                       const RenderOptions& options,
                                                       const std::function<void()>& check) {
    const IntegratorOptions& kind = options.integrator;
    // What a deep path brings of ambient light depends on what it had of it before, which no cell of the cache knows.
    if (kind.exact_translucency || !followsPaths(kind) || !scene.anyTranslucent() || maxComponent(scene.ambient) > 0.0f)
        return {};
    const auto begin = std::chrono::steady_clock::now();
    const std::size_t streams = streamsFor(options);
    RadianceCacheWork own;
    RadianceCacheWork& work = kind.cache_work ? *kind.cache_work : own;
    if (!work.cache)
        work.cache = std::make_shared<RadianceCache>(print.bounds(), cellsFor(static_cast<double>(streams * kPaths)));
    const PathIntegrator integrator(scene, print, bouncesOf(kind), work.cache.get());
    const Surfaces surfaces(scene, print);
    PerThread<std::unique_ptr<trace::Tracer>> tracers([&print] { return print.makeTracer(); });
    std::mutex checking;
    while (work.streams < streams) {
        // The picture needs the rest of its time.
        if (options.seconds > 0.0 && work.streams > 0 && secondsSince(begin) > 0.5 * options.seconds) break;
        const std::size_t count = std::min(RadianceCacheWork::kBatch, streams - work.streams);
        parallelFor(count, 1, [&](std::size_t from, std::size_t to) {
            DeepStream stream(scene, surfaces);
            for (std::size_t n = from; n != to; ++n) {
                if (work.followed[n]) continue;
                if (check) {
                    const std::lock_guard lock(checking);
                    check();
                }
                work.vertices[n].clear();
                work.followed[n] = stream.follow(integrator, work.streams + n, *tracers.local(), work.vertices[n]);
            }
        });
        // One after the other, for the sums' bits.
        for (std::size_t n = 0; n != count; ++n) work.cache->add(work.vertices[n], *work.followed[n]);
        work.followed.fill(std::nullopt);
        work.streams += count;
    }
    return work.cache;
}

}  // namespace stratum::shade
