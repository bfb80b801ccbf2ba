// What the samples of pixels add up to, and the means of that.
#pragma once

#include "shade/film/film.h"
#include "shade/integrator/aov.h"

#include <cstddef>
#include <span>
#include <vector>

namespace stratum::shade {

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

}  // namespace stratum::shade
