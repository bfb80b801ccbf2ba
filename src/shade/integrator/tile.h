// A square of pixels in the making: samples go in, in any number of goes, and means come out.
#pragma once

#include "shade/camera/filter.h"
#include "shade/camera/sampler.h"
#include "shade/integrator/aov.h"
#include "shade/integrator/integrator.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace stratum::shade {

/// What a thread has to itself.
struct TileWorker {
    std::unique_ptr<trace::Tracer> tracer;
    Sampler sampler;  // a pattern: copied for every sample
    // Samples on the way.
    std::vector<glm::ivec2> places;  // pixels
    std::vector<trace::Ray> rays;
    std::vector<Sampler> samplers;
    std::vector<SurfacePoint> points;  // what they meet first
    std::vector<Pixel> pixels;
};

/// The sums of a tile's samples. Adding samples [0, 8) and then [8, 16) gives the bits of [0, 16) at once, whichever
/// thread does it: a tile can be taken up again.
class Tile {
public:
    /// @param recorder  of the layers; only its size is kept
    Tile(const PixelBox& box, const AovRecorder& recorder);

    /// Takes samples samples(), ..., target - 1 of every pixel.
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

/// The tiles of a region, row by row. They lie on the frame's grid; those at the region's edges are cut off there.
std::vector<PixelBox> tilesOf(const PixelBox& region);

/// The smallest region of whole tiles about another, in a frame of that size.
PixelBox wholeTiles(const PixelBox& region, int width, int height);

}  // namespace stratum::shade
