// Renders a scene into a film, on all cores, with the same bytes for any number of them.
#pragma once

#include "shade/film/film.h"
#include "shade/integrator/aov.h"
#include "shade/integrator/integrator.h"
#include "shade/scene/scene.h"
#include "trace/intersector.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

namespace stratum::shade {

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
