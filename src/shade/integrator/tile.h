// A square of pixels that accumulates samples, in one or several calls, and returns their means.
#pragma once

#include "shade/camera/filter.h"
#include "shade/camera/sampler.h"
#include "shade/integrator/aov.h"
#include "shade/integrator/integrator.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace stratum::shade {

/// Pixels a side: large enough for a task, small enough for load balance.
constexpr int kTile = 32;

/// State of one thread.
struct TileWorker {
    std::unique_ptr<trace::Tracer> tracer;
    Sampler sampler;  // copied for every sample
    // The current stream of samples.
    std::vector<glm::ivec2> positions;  // pixels
    std::vector<trace::Ray> rays;
    std::vector<Sampler> samplers;
    std::vector<SurfacePoint> points;  // first hits
    std::vector<Pixel> pixels;
};

/// The sums of a tile's samples. Adding samples [0, 8) and then [8, 16) gives the same bits as [0, 16) at once, on any
/// thread.
class Tile {
public:
    /// @param recorder  of the layers; only its size is stored
    Tile(const PixelBox& box, const AovRecorder& recorder);

    /// Adds samples samples() to target - 1 of every pixel.
    void sample(int target, const Camera& camera, const Integrator& integrator, const AovRecorder& recorder,
                const PixelFilter& filter, TileWorker& worker);
    /// Root mean square over the pixels of the relative standard error of luminance, as RenderOptions::noise counts it.
    double error() const;
    /// Writes the means into the film and its layers.
    void store(Film& film, const AovRecorder& recorder) const;

    const PixelBox& box() const { return box_; }
    std::size_t pixels() const { return sums_.size(); }
    int samples() const { return samples_; }  ///< of each pixel
    const RayCounts& rays() const { return rays_; }

private:
    struct Sums {
        glm::dvec3 rgb{0.0};
        double alpha = 0.0;
        double luminance = 0.0, square = 0.0;  // sums of luminance and of its square
        void add(const Pixel& sample);
        double variance(int count) const;
    };

    PixelBox box_;
    std::vector<Sums> sums_;
    std::size_t layer_size_;
    std::vector<double> layers_;  // layer_size_ sums a pixel
    int samples_ = 0;
    RayCounts rays_;
};

/// The tiles of a region, row by row. They are aligned to the frame; those at the region's edges are clipped to it.
std::vector<PixelBox> tilesOf(const PixelBox& region);

/// The smallest region of whole tiles that contains `region`, in a frame of that size.
PixelBox wholeTiles(const PixelBox& region, int width, int height);

}  // namespace stratum::shade
