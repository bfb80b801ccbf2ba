// What the samples of pixels add up to, and the means of that.
#pragma once

#include "shade/film/exact_sums.h"
#include "shade/film/film.h"
#include "shade/integrator/aov.h"

#include <cstddef>
#include <span>
#include <vector>

namespace stratum::shade {

/// Exact sums of the samples of some pixels and of their layers. Sums of [0, 8) and of [8, 16), added in this order,
/// are those of [0, 16): the order matters for ids alone, of which the first one counts.
class PixelSums {
public:
    PixelSums() = default;
    PixelSums(std::size_t pixels, std::vector<Aov> aovs);

    /// Adds samples, and their rays' first hits. `points` and `rays` are as long as `samples`.
    void add(std::size_t pixel, std::span<const Pixel> samples, const AovRecorder& recorder,
             std::span<const SurfacePoint> points, std::span<const trace::Ray> rays);
    /// Adds the later samples of a pixel, of the same layers.
    void add(std::size_t pixel, const PixelSums& later, std::size_t its_pixel);

    /// The mean luminance of a pixel with `count` samples.
    double luminance(std::size_t pixel, int count) const;
    /// Variance of the mean luminance of `count` samples as if they were independent.
    double variance(std::size_t pixel, int count) const;
    /// Writes the means of `count` samples into a film, which has the layers.
    void store(std::size_t pixel, int count, Film& film, int x, int y) const;

    const std::vector<Aov>& aovs() const { return aovs_; }
    std::size_t pixels() const { return pixels_; }
    /// Sums of a pixel. They follow each other in sums(), pixel by pixel.
    std::size_t each() const { return each_; }
    ExactSums& sums() { return sums_; }
    const ExactSums& sums() const { return sums_; }

private:
    std::vector<Aov> aovs_;
    std::vector<bool> ids_;  // which of the layers' sums are ids
    std::size_t pixels_ = 0, each_ = 0;
    ExactSums sums_;
};

}  // namespace stratum::shade
