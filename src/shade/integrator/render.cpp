#include "shade/integrator/render.h"

#include "base/error.h"
#include "base/parallel_for.h"
#include "base/stopwatch.h"
#include "shade/camera/filter.h"
#include "shade/camera/ray_streams.h"
#include "shade/integrator/checkpoint.h"
#include "shade/integrator/deep_light.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace stratum::shade {
namespace {

// The sums of a pixel, before those of its layers.
enum Sum : std::size_t { kRed, kGreen, kBlue, kAlpha, kLuminance, kSquare, kOwn };

}  // namespace

PixelSums::PixelSums(std::size_t pixels, std::vector<Aov> aovs)
    : aovs_(std::move(aovs)), pixels_(pixels), each_(kOwn + sumsOf(aovs_)), sums_(pixels * each_) {}

void PixelSums::add(std::size_t pixel, std::span<const Pixel> samples, const AovRecorder& recorder,
                    std::span<const SurfacePoint> points, std::span<const trace::Ray> rays) {
    const std::span<double> own = std::span(sums_).subspan(pixel * each_, each_);
    for (const Pixel& sample : samples) {
        // Of a transparent picture, that of the picture with a bed: the noise of shadows counts.
        const auto y = static_cast<double>(shade::luminance(sample.rgb) + (1.0f - sample.alpha) * recorder.bareBed());
        own[kRed] += static_cast<double>(sample.rgb.r);
        own[kGreen] += static_cast<double>(sample.rgb.g);
        own[kBlue] += static_cast<double>(sample.rgb.b);
        own[kAlpha] += static_cast<double>(sample.alpha);
        own[kLuminance] += y;
        own[kSquare] += y * y;
    }
    if (aovs_.empty()) return;
    for (std::size_t n = 0; n < samples.size(); ++n) recorder.add(points[n], rays[n].direction, own.subspan(kOwn));
}

double PixelSums::luminance(std::size_t pixel, int count) const { return sums_[pixel * each_ + kLuminance] / count; }

double PixelSums::variance(std::size_t pixel, int count) const {
    const double n = count;
    const double mean = luminance(pixel, count);
    return std::max(0.0, sums_[pixel * each_ + kSquare] / n - mean * mean) / std::max(n - 1.0, 1.0);
}

void PixelSums::store(std::size_t pixel, int count, Film& film, int x, int y) const {
    const std::span<const double> own = std::span(sums_).subspan(pixel * each_, each_);
    const auto mean = [&](std::size_t n) { return static_cast<float>(own[n] / count); };
    // Light that the print reflects onto the bed may exceed what it keeps from it; and where it keeps nearly all, the
    // few samples of a pixel may take more from the bed's known light than there is.
    Color color(mean(kRed), mean(kGreen), mean(kBlue));
    if (film.content() == FilmContent::radiance) color = glm::max(color, Color(0.0f));
    film.at(x, y) = {color, std::clamp(mean(kAlpha), 0.0f, 1.0f)};
    storeAovs(aovs_, own.subspan(kOwn), {variance(pixel, count), static_cast<std::uint32_t>(count)}, film.layers(),
              film.index(x, y));
}

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

namespace {

constexpr int kMaxSide = 32768;
constexpr int kMaxSpp = 65536;
/// Samples of a pixel before the first estimate of its error (RenderOptions::noise): with fewer, a highlight that one
/// sample in ten hits is often missed, and its tile is stopped too early.
constexpr int kFirstSamples = 16;
/// The same with --time, where a tile can get more samples later.
constexpr int kClockSamples = 4;

/// The options with the radiance cache that the picture needs.
IntegratorOptions withCache(const SceneDescription& scene, const trace::Intersector& print,
                            const RenderOptions& options, const Progress& progress, double& seconds) {
    IntegratorOptions kind = options.integrator;
    if (kind.radiance_cache) return kind;
    Stopwatch watch;
    kind.radiance_cache = makeRadianceCache(scene, print, options, [&progress] {
        if (progress) progress(0, 1);
    });
    seconds = watch.lap();
    return kind;
}

/// What all tiles of a render share.
class Renderer {
public:
    Renderer(const trace::Intersector& print, const SceneDescription& scene, const RenderOptions& options,
             const Progress& progress)
        : print_(print),
          scene_(scene),
          options_(options),
          progress_(progress),
          kind_(withCache(scene, print, options, progress, cache_seconds_)),
          integrator_(makeIntegrator(kind_, scene, print)),
          recorder_(scene, print, options.aovs),
          // With --noise the number of samples of a tile depends on all of its pixels, so a crop needs whole tiles.
          region_(options.noise > 0.0 ? wholeTiles(options.region(), options.width, options.height) : options.region()),
          boxes_(tilesOf(region_)),
          pixels_(static_cast<std::uint64_t>(region_.width()) * static_cast<std::uint64_t>(region_.height())),
          workers_([this] { return makeWorker(); }) {
        state_.film = Film(options.width, options.height, region_, integrator_->content());
        if (scene.transparent) state_.film.makeTransparent(recorder_.bareBed());
        state_.film.layers() = makeLayers(options.aovs, state_.film.pixels().size());
        state_.done.resize(boxes_.size(), 0);
    }

    RenderResult run() {
        if (options_.seconds > 0.0)
            byTheClock();
        else
            tileByTile();
        const double mean_spp = static_cast<double>(state_.samples) / static_cast<double>(pixels_);
        const bool more = region_ != options_.region();
        return {more ? state_.film.part(options_.region()) : std::move(state_.film),
                mean_spp,
                state_.rays,
                state_.samples,
                pixels_,
                kind_.radiance_cache,
                cache_seconds_};
    }

private:
    using Clock = std::chrono::steady_clock;

    TileWorker makeWorker() const {
        return {print_.makeTracer(), Sampler(options_.seed, static_cast<std::uint32_t>(options_.spp))};
    }
    void sample(Tile& tile, int target, TileWorker& worker) const {
        tile.sample(target, scene_.camera, *integrator_, recorder_, filter_, worker);
    }
    /// Adds a finished tile to the state. Not for two threads at once.
    void finish(std::size_t index, const Tile& tile) {
        tile.store(state_.film);
        state_.done[index] = 1;
        state_.rays += tile.rays();
        state_.samples += static_cast<std::uint64_t>(tile.samples()) * tile.pixels();
    }
    void tileByTile();
    void byTheClock();
    std::string identity() const;

    const trace::Intersector& print_;
    const SceneDescription& scene_;
    const RenderOptions& options_;
    const Progress& progress_;
    const Clock::time_point begin_ = Clock::now();
    double cache_seconds_ = 0.0;
    const IntegratorOptions kind_;
    const std::unique_ptr<Integrator> integrator_;
    const AovRecorder recorder_;
    const PixelFilter filter_;
    const PixelBox region_;
    const std::vector<PixelBox> boxes_;
    const std::uint64_t pixels_;
    PerThread<TileWorker> workers_;
    RenderState state_;
};

/// Everything the picture depends on: the options as text, RenderOptions::source, and a hash of a few thousand samples.
std::string Renderer::identity() const {
    constexpr int kProbes = 4096;
    TileWorker worker = makeWorker();
    for (int n = 0; n < kProbes; ++n) {
        Sampler sampler(0x9e3779b9u, kProbes);
        sampler.start(0, 0, static_cast<std::uint32_t>(n));
        worker.rays.push_back(anyPrimaryRay(scene_.camera, sampler));
        worker.samplers.push_back(sampler);
    }
    worker.points.resize(kProbes);
    worker.pixels.resize(kProbes);
    RayCounts ignored;
    integrator_->radianceStream(worker.rays, worker.samplers, *worker.tracer, ignored, worker.points, worker.pixels);
    std::uint32_t look = 0;
    for (const Pixel& p : worker.pixels)
        for (const float v : {p.rgb.r, p.rgb.g, p.rgb.b, p.alpha})
            look = sobol::hash(look, std::bit_cast<std::uint32_t>(v));
    const IntegratorOptions& i = options_.integrator;
    const auto& box = print_.bounds();
    std::string text = fmt::format(
        "{}x{} region {},{},{},{} spp {} noise {} seed {} march {} voxel {} box {},{},{},{},{},{} integrator {} {} {} "
        "{} "
        "{} {} {} {} layers",
        options_.width, options_.height, region_.x0, region_.y0, region_.x1, region_.y1, options_.spp, options_.noise,
        options_.seed, print_.name(), print_.voxelSize(), box.min.x, box.min.y, box.min.z, box.max.x, box.max.y,
        box.max.z, i.name, i.bounces, i.phong.ambient, i.phong.diffuse, i.phong.specular, i.phong.shininess,
        i.phong.reflective, i.ao_distance);
    for (const FilmLayer& layer : state_.film.layers()) text += " " + layer.name;
    return text + fmt::format(" look {:08x} source {}", look, options_.source);
}

/// Every tile from its first sample to its last, and then the next one.
void Renderer::tileByTile() {
    std::optional<Checkpoint> checkpoint;
    if (!options_.checkpoint.empty()) {
        checkpoint.emplace(options_.checkpoint, identity());
        if (!checkpoint->read(state_)) checkpoint->write(checkpoint->bytesOf(state_));  // an unwritable path fails now
    }
    std::vector<std::size_t> todo;
    for (std::size_t n = 0; n < boxes_.size(); ++n)
        if (state_.done[n] == 0) todo.push_back(n);

    std::mutex mutex;
    std::uint64_t done = pixels_;
    for (const std::size_t n : todo) done -= Tile(boxes_[n], recorder_).pixels();
    auto written = Clock::now();
    bool writing = false;
    parallelFor(todo.size(), 1, [&](std::size_t first, std::size_t last) {
        TileWorker& worker = workers_.local();
        for (std::size_t n = first; n != last; ++n) {
            Tile tile(boxes_[todo[n]], recorder_);
            int target = options_.noise > 0.0 ? std::min(kFirstSamples, options_.spp) : options_.spp;
            sample(tile, target, worker);
            while (options_.noise > 0.0 && target < options_.spp && tile.error() > options_.noise) {
                target = std::min(2 * target, options_.spp);
                sample(tile, target, worker);
            }
            std::string bytes;
            {
                const std::lock_guard lock(mutex);
                finish(todo[n], tile);
                done += tile.pixels();
                if (progress_) progress_(done, pixels_);
                if (!checkpoint || writing) continue;
                const std::chrono::duration<double> since = Clock::now() - written;
                if (since.count() < options_.checkpoint_interval) continue;
                bytes = checkpoint->bytesOf(state_);
                writing = true;
            }
            // Writing may take long; the other threads continue meanwhile.
            checkpoint->write(bytes);
            const std::lock_guard lock(mutex);
            written = Clock::now();
            writing = false;
        }
    });
    if (checkpoint && !todo.empty()) checkpoint->write(checkpoint->bytesOf(state_));
}

/// All tiles a little, and then the worst ones more, until the time is over.
void Renderer::byTheClock() {
    const auto elapsed = [begin = begin_] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
    std::vector<Tile> tiles;
    tiles.reserve(boxes_.size());
    for (const PixelBox& box : boxes_) tiles.emplace_back(box, recorder_);
    std::mutex mutex;
    std::uint64_t shown = 0;
    std::vector<std::size_t> todo(tiles.size());
    for (std::size_t n = 0; n < todo.size(); ++n) todo[n] = n;
    while (!todo.empty()) {
        parallelFor(todo.size(), 1, [&](std::size_t first, std::size_t last) {
            TileWorker& worker = workers_.local();
            for (std::size_t n = first; n != last; ++n) {
                Tile& tile = tiles[todo[n]];
                // The first samples are taken even after the deadline: every pixel needs some.
                if (tile.samples() > 0 && elapsed() >= options_.seconds) return;
                sample(tile, std::min(std::max(kClockSamples, 2 * tile.samples()), options_.spp), worker);
                if (!progress_) continue;
                const std::lock_guard lock(mutex);
                const double part = std::min(1.0, elapsed() / options_.seconds);
                const auto now = static_cast<std::uint64_t>(part * static_cast<double>(pixels_ - 1));
                if (now > shown) progress_(shown = now, pixels_);
            }
        });
        if (elapsed() >= options_.seconds) break;
        // Next: the worse half of the tiles that are not finished.
        std::vector<std::pair<double, std::size_t>> errors;
        for (std::size_t n = 0; n < tiles.size(); ++n) {
            const double error = tiles[n].error();
            if (tiles[n].samples() < options_.spp && error > options_.noise) errors.emplace_back(-error, n);
        }
        std::sort(errors.begin(), errors.end());
        todo.clear();
        for (std::size_t k = 0; k < (errors.size() + 1) / 2; ++k) todo.push_back(errors[k].second);
    }
    for (std::size_t n = 0; n < tiles.size(); ++n) finish(n, tiles[n]);
    if (progress_) progress_(pixels_, pixels_);
}

}  // namespace

PixelBox RenderOptions::region() const {
    if (!crop) return {0, 0, width, height};
    return {std::max(crop->x0 - margin, 0), std::max(crop->y0 - margin, 0), std::min(crop->x1 + margin, width),
            std::min(crop->y1 + margin, height)};
}

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
    if (!(seconds >= 0.0 && seconds <= 1e7))
        throw UsageError(fmt::format("--time {}: must be from 0 to 1e7 s", seconds));
    if (seconds > 0.0 && !checkpoint.empty())
        throw UsageError("--checkpoint is for pictures of so many samples; one by the clock (--time) can't be resumed");
    integrator.validate();
}

RenderResult render(const trace::Intersector& print, const SceneDescription& scene, const RenderOptions& options,
                    const Progress& progress) {
    options.validate();
    if (scene.camera.width() != options.width || scene.camera.height() != options.height)
        throw UsageError(fmt::format("the camera was made for {}x{} pixels, the picture has {}x{}",
                                     scene.camera.width(), scene.camera.height(), options.width, options.height));
    return Renderer(print, scene, options, progress).run();
}

}  // namespace stratum::shade
