// A square of pixels that accumulates samples, in one or several calls, and returns their means.
#pragma once

#include "shade/camera/filter.h"
#include "shade/camera/sampler.h"
#include "shade/integrator/aov.h"
#include "shade/integrator/integrator.h"
#include "shade/integrator/pixel_sums.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace stratum::shade {

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

}  // namespace stratum::shade
