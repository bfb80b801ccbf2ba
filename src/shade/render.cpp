#include "shade/render.h"

#include "io/error.h"
#include "parallel/parallel_for.h"
#include "shade/filter.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <mutex>

namespace stratum::shade {
namespace {

constexpr int kTile = 32;  // pixels a side: work enough for a task, few enough for balance
constexpr int kMaxSide = 32768;
constexpr int kMaxSpp = 65536;

/// What a thread has to itself.
struct Worker {
    std::unique_ptr<march::Tracer> tracer;
    Sampler sampler;
    RayCounts rays;
};

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
    RenderResult result{Film(options.width, options.height, region, integrator->content()), {}};

    const auto renderPixel = [&](int x, int y, Worker& worker) {
        TraceContext context{*worker.tracer, worker.sampler, worker.rays};
        glm::dvec3 rgb(0.0);
        double alpha = 0.0;
        for (int s = 0; s < options.spp; ++s) {
            worker.sampler.start(x, y, static_cast<std::uint32_t>(s));
            const glm::dvec2 place = glm::dvec2(x + 0.5, y + 0.5) + filter.offset(worker.sampler.next2D());
            const Pixel sample = integrator->radiance(scene.camera.ray(place), context);
            rgb += glm::dvec3(sample.rgb);
            alpha += static_cast<double>(sample.alpha);
        }
        return Pixel{Color(rgb / static_cast<double>(options.spp)), static_cast<float>(alpha / options.spp)};
    };

    const std::vector<PixelBox> tiles = tilesOf(region);
    tbb::enumerable_thread_specific<Worker> workers([&] {
        return Worker{print.makeTracer(), Sampler(options.seed, static_cast<std::uint32_t>(options.spp)), RayCounts{}};
    });
    std::mutex progress_mutex;
    std::uint64_t done = 0;
    const std::uint64_t total =
        static_cast<std::uint64_t>(region.width()) * static_cast<std::uint64_t>(region.height());
    parallelFor(tiles.size(), 1, [&](std::size_t first, std::size_t last) {
        Worker& worker = workers.local();
        for (std::size_t i = first; i != last; ++i) {
            const PixelBox& tile = tiles[i];
            for (int y = tile.y0; y < tile.y1; ++y)
                for (int x = tile.x0; x < tile.x1; ++x) result.film.at(x, y) = renderPixel(x, y, worker);
            if (!progress) continue;
            const std::lock_guard lock(progress_mutex);
            done += static_cast<std::uint64_t>(tile.width()) * static_cast<std::uint64_t>(tile.height());
            progress(done, total);
        }
    });
    for (const Worker& worker : workers) result.rays += worker.rays;
    return result;
}

}  // namespace stratum::shade
