// Renders a scene into a film, on all cores, with the same bytes for any number of them.
#pragma once

#include "shade/camera/filter.h"
#include "shade/camera/sampler.h"
#include "shade/film/film.h"
#include "shade/integrator/aov.h"
#include "shade/integrator/integrator.h"
#include "shade/scene/scene.h"
#include "trace/intersector.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace stratum::shade {

// What the samples of pixels add up to, and the means of that.

/// Sums of the samples of some pixels and of their layers.
class PixelSums {
public:
    PixelSums() = default;
    PixelSums(std::size_t pixels, std::vector<Aov> aovs);

    /// Adds samples, and their rays' first hits. `points` and `rays` are as long as `samples`.
    void add(std::size_t pixel, std::span<const Pixel> samples, const AovRecorder& recorder,
             std::span<const SurfacePoint> points, std::span<const trace::Ray> rays);

    /// The mean luminance of a pixel with `count` samples.
    double luminance(std::size_t pixel, int count) const;
    /// Variance of the mean luminance of `count` samples as if they were independent.
    double variance(std::size_t pixel, int count) const;
    /// Writes the means of `count` samples into a film, which has the layers.
    void store(std::size_t pixel, int count, Film& film, int x, int y) const;

    const std::vector<Aov>& aovs() const { return aovs_; }
    std::size_t pixels() const { return pixels_; }

private:
    std::vector<Aov> aovs_;
    std::size_t pixels_ = 0;
    std::size_t each_ = 0;  // sums of a pixel
    std::vector<double> sums_;
};

// A square of pixels that accumulates samples, in one or several calls, and returns their means.

/// Pixels a side: large enough for a task, small enough for load balance.
constexpr int kTile = 32;

/// State of one thread.
struct TileWorker {
    std::unique_ptr<trace::Tracer> tracer;
    Sampler sampler;                     // copied for every sample
    std::vector<std::uint32_t> order{};  // of a tile's pixels, by number
    // The current stream of samples.
    std::vector<glm::ivec2> positions{};  // pixels
    std::vector<trace::Ray> rays{};
    std::vector<Sampler> samplers{};
    std::vector<SurfacePoint> points{};  // first hits
    std::vector<Pixel> pixels{};
};

/// The sums of a tile's samples. Adding samples [0, 8) and then [8, 16) gives the same bits as [0, 16) at once, on any
/// thread.
class Tile {
public:
    /// @param recorder  of the layers; only their names are stored
    Tile(const PixelBox& box, const AovRecorder& recorder);

    /// Adds samples to every pixel, from the one after its last to target - 1.
    void sample(int target, const Camera& camera, const Integrator& integrator, const AovRecorder& recorder,
                const PixelFilter& filter, TileWorker& worker);
    /// Root mean square over the pixels of the standard error of luminance, by the tile's mean luminance, as
    /// RenderOptions::noise counts it. A pixel's own mean would not do: where a rare sample is most of the light, the
    /// pixels that have it are bright and those that still lack it have no variance, so that all look finished.
    double error() const;
    /// Writes the means into the film and its layers.
    void store(Film& film) const;

    const PixelBox& box() const { return box_; }
    std::size_t pixels() const { return sums_.pixels(); }
    int samples() const { return samples_; }  ///< of each pixel
    const RayCounts& rays() const { return rays_; }

private:
    PixelBox box_;
    PixelSums sums_;
    int samples_ = 0;  // of each pixel, that are summed
    RayCounts rays_;
};

/// The tiles of a region, row by row. They are aligned to the frame; those at the region's edges are clipped to it.
std::vector<PixelBox> tilesOf(const PixelBox& region);

/// The smallest region of whole tiles that contains `region`, in a frame of that size.
PixelBox wholeTiles(const PixelBox& region, int width, int height);

struct RenderOptions {
    int width = 1280;  ///< pixels, 1 to 32768
    int height = 960;  ///< pixels, 1 to 32768
    int spp = 16;      ///< samples a pixel, 1 to 65536; powers of two are best. With `noise`: at most
    /// --noise: 0, or the error at which a tile of 32 x 32 pixels is finished, in (0, 1]: root mean square over the
    /// tile's pixels of the standard error of luminance, over sqrt(L^2 + 0.01), L being the tile's mean luminance. Each
    /// tile gets 16 samples, then twice as many, etc.
    double noise = 0.0;
    /// --time: 0, or seconds. Every tile gets 4 samples; then those with the largest errors get twice as many,
    /// repeatedly, until the time is over, or all reach `noise` or `spp`. The film is not reproducible: it depends on
    /// the machine and its load.
    double seconds = 0.0;
    /// --checkpoint: empty, or a file that keeps the finished tiles. If it is there already, they are not rendered
    /// again, and the film has the bytes of a render without interruption. Not with `seconds`.
    std::filesystem::path checkpoint;
    /// One line of text that identifies the input of print and scene, e.g. hashes of files and options: a checkpoint of
    /// another is refused. Differences that it doesn't name are detected by comparing a few thousand samples.
    std::string source;
    double checkpoint_interval = 20.0;  ///< seconds between writings of that file
    std::vector<Aov> aovs;              ///< --aov: layers of the film
    std::uint32_t seed = 0;             ///< selects the noise pattern
    std::optional<PixelBox> crop;       ///< --crop: only this part of the same picture; must lie in the frame
    int margin = 0;  ///< pixels around the crop, inside the frame, that are rendered and kept as well
    IntegratorOptions integrator;

    /// The crop with its margin, or the whole frame.
    PixelBox region() const;
    /// Throws UsageError.
    void validate() const;
};

struct RenderResult {
    Film film;              ///< of options.region()
    double mean_spp = 0.0;  ///< samples a pixel
    RayCounts rays;         ///< the same for any number of threads; without those of the radiance cache
    /// What mean_spp is the quotient of. With RenderOptions::noise: of whole tiles around a crop.
    std::uint64_t samples = 0, pixels = 0;
    std::shared_ptr<const RadianceCache> radiance_cache;  ///< that it used; null: none
    double radiance_cache_seconds = 0.0;                  ///< that it took to make it
};

/// Called from time to time from any thread, never from two at once, with the number of finished pixels.
using Progress = std::function<void(std::uint64_t done, std::uint64_t total)>;

/// Renders. Runs on the threads that TBB may use: limit them with tbb::global_control. The film depends on print, scene
/// and options alone. scene.camera must have been made for options.width and options.height (UsageError if not).
/// Throws UsageError; InputError for a checkpoint that is damaged or another picture's; OutputError if it can't be
/// written. What `progress` throws ends the render and is passed on.
RenderResult render(const trace::Intersector& print, const SceneDescription& scene, const RenderOptions& options,
                    const Progress& progress = {});

}  // namespace stratum::shade
