#include "shade/integrator/tile.h"

#include "shade/integrator/primary_rays.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace stratum::shade {
namespace {

constexpr std::size_t kStream = 4096;  // samples at a time: enough to fill vectors, few enough for the cache

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

void Tile::Sums::add(const Pixel& sample) {
    rgb += glm::dvec3(sample.rgb);
    alpha += static_cast<double>(sample.alpha);
    const auto y = static_cast<double>(shade::luminance(sample.rgb));
    luminance += y;
    square += y * y;
}

/// Variance of the mean luminance of `count` samples as if they were independent.
double Tile::Sums::variance(int count) const {
    const double n = count;
    const double mean = luminance / n;
    return std::max(0.0, square / n - mean * mean) / std::max(n - 1.0, 1.0);
}

Tile::Tile(const PixelBox& box, const AovRecorder& recorder)
    : box_(box),
      sums_(static_cast<std::size_t>(box.width()) * static_cast<std::size_t>(box.height())),
      layer_size_(recorder.size()),
      layers_(sums_.size() * recorder.size(), 0.0) {}

void Tile::sample(int target, const Camera& camera, const Integrator& integrator, const AovRecorder& recorder,
                  const PixelFilter& filter, TileWorker& worker) {
    // The integrator gets the samples in streams, pixel by pixel; they are summed in that order.
    const auto each = static_cast<std::size_t>(target - samples_);
    const std::size_t most = std::min(kStream, sums_.size() * each);
    worker.positions.resize(most);
    worker.rays.resize(most);
    worker.samplers.resize(most, worker.sampler);
    worker.points.resize(most);
    worker.pixels.resize(most);
    std::size_t waiting = 0;
    std::size_t pixel = 0;  // the pixel being summed
    std::size_t taken = 0;  // its samples so far
    const auto flush = [&] {
        primaryRays(camera, filter, std::span(worker.positions).first(waiting),
                    std::span(worker.samplers).first(waiting), std::span(worker.rays).first(waiting));
        integrator.radianceStream(std::span(worker.rays).first(waiting), std::span(worker.samplers).first(waiting),
                                  *worker.tracer, rays_, std::span(worker.points).first(waiting),
                                  std::span(worker.pixels).first(waiting));
        for (std::size_t n = 0; n < waiting; ++n) {
            sums_[pixel].add(worker.pixels[n]);
            recorder.add(worker.points[n], worker.rays[n].direction, layers_.data() + pixel * layer_size_);
            if (++taken < each) continue;
            taken = 0;
            ++pixel;
        }
        waiting = 0;
    };
    for (int y = box_.y0; y < box_.y1; ++y)
        for (int x = box_.x0; x < box_.x1; ++x) {
            Sampler sampler = worker.sampler;
            sampler.start(x, y, static_cast<std::uint32_t>(samples_));
            for (int s = samples_; s < target; ++s, sampler.startNext()) {
                worker.samplers[waiting] = sampler;
                worker.positions[waiting] = {x, y};
                if (++waiting == kStream) flush();
            }
        }
    flush();
    samples_ = target;
}

double Tile::error() const {
    double sum = 0.0;
    for (const Sums& s : sums_) {
        const double mean = s.luminance / samples_;
        sum += s.variance(samples_) / (mean * mean + 0.01);
    }
    return std::sqrt(sum / static_cast<double>(sums_.size()));
}

void Tile::store(Film& film, const AovRecorder& recorder) const {
    const auto width = static_cast<std::size_t>(box_.width());
    for (std::size_t n = 0; n < sums_.size(); ++n) {
        const int x = box_.x0 + static_cast<int>(n % width);
        const int y = box_.y0 + static_cast<int>(n / width);
        film.at(x, y) = {Color(sums_[n].rgb / static_cast<double>(samples_)),
                         static_cast<float>(sums_[n].alpha / samples_)};
        recorder.store(layers_.data() + n * layer_size_,
                       {sums_[n].variance(samples_), static_cast<std::uint32_t>(samples_)}, film.layers(),
                       film.index(x, y));
    }
}

}  // namespace stratum::shade
