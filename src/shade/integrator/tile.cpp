#include "shade/integrator/tile.h"

#include "shade/camera/primary_rays.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace stratum::shade {
namespace {

constexpr std::size_t kStream = 4096;  // samples at a time: enough to fill vectors, few enough for the cache
constexpr int kBlock = 4;              // pixels a side: as many rays as a vector or a packet has lanes

// The pixels of a box in blocks, so that rays which are traced together go the same way. Numbers are row by row.
void orderPixels(const PixelBox& box, std::vector<std::uint32_t>& order) {
    order.clear();
    for (int by = 0; by < box.height(); by += kBlock)
        for (int bx = 0; bx < box.width(); bx += kBlock)
            for (int y = by; y < std::min(by + kBlock, box.height()); ++y)
                for (int x = bx; x < std::min(bx + kBlock, box.width()); ++x)
                    order.push_back(static_cast<std::uint32_t>(y * box.width() + x));
}

}  // namespace

std::vector<PixelBox> tilesOf(const PixelBox& region) {
    std::vector<PixelBox> tiles;
    for (int y = region.y0 / kTile * kTile; y < region.y1; y += kTile)
        for (int x = region.x0 / kTile * kTile; x < region.x1; x += kTile)
            tiles.push_back({std::max(x, region.x0), std::max(y, region.y0), std::min(x + kTile, region.x1),
                             std::min(y + kTile, region.y1)});
    return tiles;
}

PixelBox wholeTiles(const PixelBox& region, int width, int height) {
    const auto up = [](int n) { return (n + kTile - 1) / kTile * kTile; };
    return {region.x0 / kTile * kTile, region.y0 / kTile * kTile, std::min(up(region.x1), width),
            std::min(up(region.y1), height)};
}

Tile::Tile(const PixelBox& box, const AovRecorder& recorder)
    : box_(box),
      sums_(static_cast<std::size_t>(box.width()) * static_cast<std::size_t>(box.height()), recorder.aovs()) {}

void Tile::sample(int target, const Camera& camera, const Integrator& integrator, const AovRecorder& recorder,
                  const PixelFilter& filter, TileWorker& worker) {
    // The integrator gets the samples in streams, pixel by pixel; they are summed in that order.
    orderPixels(box_, worker.order);
    const auto each = static_cast<std::size_t>(target - samples_);
    const std::size_t most = std::min(kStream, sums_.pixels() * each);
    worker.positions.resize(most);
    worker.rays.resize(most);
    worker.samplers.resize(most, worker.sampler);
    worker.points.resize(most);
    worker.pixels.resize(most);
    std::size_t waiting = 0;
    std::size_t pixel = 0;  // the place in that order of the pixel being summed
    std::size_t taken = 0;  // its samples so far
    const auto flush = [&] {
        primaryRays(camera, filter, std::span(worker.positions).first(waiting),
                    std::span(worker.samplers).first(waiting), std::span(worker.rays).first(waiting));
        integrator.radianceStream(std::span(worker.rays).first(waiting), std::span(worker.samplers).first(waiting),
                                  *worker.tracer, rays_, std::span(worker.points).first(waiting),
                                  std::span(worker.pixels).first(waiting));
        for (std::size_t n = 0; n < waiting;) {
            const std::size_t count = std::min(each - taken, waiting - n);
            sums_.add(worker.order[pixel], std::span(worker.pixels).subspan(n, count), recorder,
                      std::span(worker.points).subspan(n, count), std::span(worker.rays).subspan(n, count));
            n += count;
            taken += count;
            if (taken < each) continue;
            taken = 0;
            ++pixel;
        }
        waiting = 0;
    };
    for (const std::uint32_t number : worker.order) {
        const glm::ivec2 at(box_.x0 + static_cast<int>(number) % box_.width(),
                            box_.y0 + static_cast<int>(number) / box_.width());
        Sampler sampler = worker.sampler;
        sampler.start(at.x, at.y, static_cast<std::uint32_t>(samples_));
        for (int s = samples_; s < target; ++s, sampler.startNext()) {
            worker.samplers[waiting] = sampler;
            worker.positions[waiting] = at;
            if (++waiting == kStream) flush();
        }
    }
    flush();
    samples_ = target;
}

double Tile::error() const {
    double variance = 0.0;
    double luminance = 0.0;
    for (std::size_t n = 0; n < pixels(); ++n) {
        variance += sums_.variance(n, samples());
        luminance += sums_.luminance(n, samples());
    }
    const double mean = luminance / static_cast<double>(pixels());
    return std::sqrt(variance / static_cast<double>(pixels()) / (mean * mean + 0.01));
}

void Tile::store(Film& film) const {
    std::size_t n = 0;
    for (int y = box_.y0; y < box_.y1; ++y)
        for (int x = box_.x0; x < box_.x1; ++x) sums_.store(n++, samples(), film, x, y);
}

}  // namespace stratum::shade
