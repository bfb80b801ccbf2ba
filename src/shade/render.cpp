#include "shade/render.h"

#include "io/error.h"
#include "parallel/parallel_for.h"
#include "shade/filter.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <vector>

namespace stratum::shade {
namespace {

constexpr int kTile = 32;  // pixels a side: work enough for a task, few enough for balance
constexpr int kMaxSide = 32768;
constexpr int kMaxSpp = 65536;

constexpr std::size_t kStream = 1024;  // samples on the way at a time: enough to fill vectors, few enough for a cache

/// Camera rays on the way, with their samplers.
struct Stream {
    std::vector<march::Ray> rays;
    std::vector<Sampler> samplers;
    std::vector<SurfacePoint> points;  // what they meet first
    std::vector<Pixel> pixels;
};

/// What a thread has to itself.
struct Worker {
    std::unique_ptr<march::Tracer> tracer;
    Sampler sampler;
    RayCounts rays;
    Stream stream;
    std::uint64_t samples = 0;
};

/// A pixel in the making.
struct Sums {
    glm::dvec3 rgb{0.0};
    double alpha = 0.0;
    double luminance = 0.0, square = 0.0;  // sums of luminance and of its square

    void add(const Pixel& sample) {
        rgb += glm::dvec3(sample.rgb);
        alpha += static_cast<double>(sample.alpha);
        const auto y = static_cast<double>(shade::luminance(sample.rgb));
        luminance += y;
        square += y * y;
    }

    /// Variance of the mean luminance of `count` samples as if they were independent.
    double variance(int count) const {
        const double n = count;
        const double mean = luminance / n;
        return std::max(0.0, square / n - mean * mean) / std::max(n - 1.0, 1.0);
    }
};

/// Root mean square of the relative standard errors of a tile's pixels.
double errorOf(const std::vector<Sums>& tile, int count) {
    double sum = 0.0;
    for (const Sums& s : tile) {
        const double mean = s.luminance / count;
        sum += s.variance(count) / (mean * mean + 0.01);
    }
    return std::sqrt(sum / static_cast<double>(tile.size()));
}

std::vector<PixelBox> tilesOf(const PixelBox& region) {
    std::vector<PixelBox> tiles;
    for (int y = region.y0; y < region.y1; y += kTile)
        for (int x = region.x0; x < region.x1; x += kTile)
            tiles.push_back({x, y, std::min(x + kTile, region.x1), std::min(y + kTile, region.y1)});
    return tiles;
}

}  // namespace

void RenderOptions::validate() const {
    if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide)
        throw UsageError(fmt::format("--size {}x{}: each side must be from 1 to {} pixels", width, height, kMaxSide));
    if (spp < 1 || spp > kMaxSpp) throw UsageError(fmt::format("--spp {}: must be from 1 to {}", spp, kMaxSpp));
    if (crop && (crop->x0 < 0 || crop->y0 < 0 || crop->x1 > width || crop->y1 > height || crop->x0 >= crop->x1 ||
                 crop->y0 >= crop->y1))
        throw UsageError(fmt::format("--crop {},{},{},{}: must be a part of the {}x{} picture, X0 < X1 and Y0 < Y1",
                                     crop->x0, crop->y0, crop->x1, crop->y1, width, height));
    if (!(noise >= 0.0 && noise <= 1.0))
        throw UsageError(fmt::format("--noise {}: must be above 0 and at most 1", noise));
    if (spp < 2 && std::find(aovs.begin(), aovs.end(), Aov::variance) != aovs.end())
        throw UsageError("--aov variance needs --spp 2 or more: one sample has no spread");
    integrator.validate();
}

RenderResult render(const march::Intersector& print, const SceneDescription& scene, const RenderOptions& options,
                    const Progress& progress) {
    options.validate();
    if (scene.camera.width() != options.width || scene.camera.height() != options.height)
        throw UsageError(fmt::format("the camera was made for {}x{} pixels, the picture has {}x{}",
                                     scene.camera.width(), scene.camera.height(), options.width, options.height));
    const auto integrator = makeIntegrator(options.integrator, scene, print);
    const PixelFilter filter;
    const PixelBox region = options.crop.value_or(PixelBox{0, 0, options.width, options.height});
    RenderResult result{Film(options.width, options.height, region, integrator->content()), 0.0, {}};
    const AovRecorder recorder(scene, print, options.aovs);
    result.film.layers() = makeLayers(options.aovs, result.film.pixels().size());

    const auto renderTile = [&](const PixelBox& tile, Worker& worker) {
        const auto count = static_cast<std::size_t>(tile.width()) * static_cast<std::size_t>(tile.height());
        const auto width = static_cast<std::size_t>(tile.width());
        Stream& stream = worker.stream;
        std::vector<Sums> sums(count);
        std::vector<double> layers(count * recorder.size(), 0.0);
        int done = 0;
        int target = options.noise > 0.0 ? std::min(16, options.spp) : options.spp;
        for (;;) {
            // Samples go to the integrator in streams, pixel by pixel, and are summed in that order.
            const auto each = static_cast<std::size_t>(target - done);
            std::size_t summed = 0;
            const auto flush = [&] {
                stream.points.resize(stream.rays.size());
                stream.pixels.resize(stream.rays.size());
                integrator->radianceStream(stream.rays, stream.samplers, *worker.tracer, worker.rays, stream.points,
                                           stream.pixels);
                for (std::size_t n = 0; n < stream.pixels.size(); ++n) {
                    const std::size_t pixel = summed++ / each;
                    sums[pixel].add(stream.pixels[n]);
                    recorder.add(stream.points[n], layers.data() + pixel * recorder.size());
                }
                stream.rays.clear();
                stream.samplers.clear();
            };
            for (int y = tile.y0; y < tile.y1; ++y)
                for (int x = tile.x0; x < tile.x1; ++x)
                    for (int s = done; s < target; ++s) {
                        Sampler sampler = worker.sampler;
                        sampler.start(x, y, static_cast<std::uint32_t>(s));
                        const glm::dvec2 place = glm::dvec2(x + 0.5, y + 0.5) + filter.offset(sampler.next2D());
                        stream.rays.push_back(scene.camera.ray(place));
                        stream.samplers.push_back(sampler);
                        if (stream.rays.size() == kStream) flush();
                    }
            flush();
            done = target;
            if (done == options.spp || errorOf(sums, done) <= options.noise) break;
            target = std::min(2 * done, options.spp);
        }
        worker.samples += static_cast<std::uint64_t>(done) * count;
        for (std::size_t n = 0; n < count; ++n) {
            const int x = tile.x0 + static_cast<int>(n % width);
            const int y = tile.y0 + static_cast<int>(n / width);
            result.film.at(x, y) = {Color(sums[n].rgb / static_cast<double>(done)),
                                    static_cast<float>(sums[n].alpha / done)};
            recorder.store(layers.data() + n * recorder.size(),
                           {sums[n].variance(done), static_cast<std::uint32_t>(done)}, result.film.layers(),
                           result.film.index(x, y));
        }
    };

    const std::vector<PixelBox> tiles = tilesOf(region);
    tbb::enumerable_thread_specific<Worker> workers([&] {
        return Worker{
            print.makeTracer(), Sampler(options.seed, static_cast<std::uint32_t>(options.spp)), RayCounts{}, {}, 0};
    });
    std::mutex progress_mutex;
    std::uint64_t done = 0;
    const std::uint64_t total =
        static_cast<std::uint64_t>(region.width()) * static_cast<std::uint64_t>(region.height());
    parallelFor(tiles.size(), 1, [&](std::size_t first, std::size_t last) {
        Worker& worker = workers.local();
        for (std::size_t i = first; i != last; ++i) {
            const PixelBox& tile = tiles[i];
            renderTile(tile, worker);
            if (!progress) continue;
            const std::lock_guard lock(progress_mutex);
            done += static_cast<std::uint64_t>(tile.width()) * static_cast<std::uint64_t>(tile.height());
            progress(done, total);
        }
    });
    std::uint64_t samples = 0;
    for (const Worker& worker : workers) {
        result.rays += worker.rays;
        samples += worker.samples;
    }
    result.mean_spp = static_cast<double>(samples) / static_cast<double>(total);
    return result;
}

}  // namespace stratum::shade
