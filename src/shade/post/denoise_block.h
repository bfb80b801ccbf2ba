// The inner loops of denoise(): one block of pixels at a time, in the lanes of vectors.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace stratum::shade {

/// The parameters of the estimator described in denoise.h.
struct Denoising {
    static constexpr int kRadius = 7;      ///< pixels: largest offset of neighbours
    static constexpr int kPatch = 2;       ///< pixels: radius of the patches that are compared
    static constexpr float kLight = 0.6f;  ///< tolerance of differences in color, relative to the noise (Rousselle)
    /// Ridge of the regression, relative to the sum of weights: guides whose standard deviation is less than the root
    /// of this have little influence.
    static constexpr float kRidge = 3e-5f;
    /// The weight of a distance d is max(0, 1 - d / 8)^8: close to exp(-d), with finite support.
    static constexpr float kEnd = 8.0f;
};

/// A film as planes of floats with a mirrored margin, so that loops need no bounds checks.
class DenoisePlanes {
public:
    enum Plane {
        brightness,
        variance,   // of the mean luminance
        closeness,  // kCloseness planes: the distance of two pixels in guides is the sum of their squared differences
        terms = closeness + 7,  // kTerms planes: variables of the linear function, beside the position
        color = terms + 3,      // 3 planes
        alpha = color + 3,      // of transparent films
        kPlanes = alpha + 1
    };
    static constexpr int kCloseness = 7;
    static constexpr int kTerms = 3;
    static constexpr int kBlockWidth = 64, kBlockHeight = 16;  // pixels
    static constexpr int kMargin = 16;                         // pixels, left and above; more on the other sides

    /// @param with_alpha  alpha is fitted like a color; else there is no such plane
    DenoisePlanes(int width, int height, bool with_alpha = false);
    /// Planes that are fitted, from `color` on: 3 or 4.
    std::size_t channels() const { return values_[alpha].empty() ? 3 : 4; }
    int width() const { return width_; }
    int height() const { return height_; }
    /// Rows and columns that exist: from -kMargin to these, exclusive.
    int endX() const { return end_x_; }
    int endY() const { return end_y_; }
    float* at(int plane, int x, int y) { return values_[static_cast<std::size_t>(plane)].data() + index(x, y); }
    const float* at(int plane, int x, int y) const {
        return values_[static_cast<std::size_t>(plane)].data() + index(x, y);
    }

private:
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y + kMargin) * stride_ + static_cast<std::size_t>(x + kMargin);
    }
    int width_, height_, end_x_, end_y_;
    std::size_t stride_;
    std::array<std::vector<float>, kPlanes> values_;
};

/// Scratch memory of one thread.
struct DenoiseScratch {
    std::vector<float> weights;                ///< of each neighbour, of each pixel
    std::array<std::vector<float>, 4> colors;  ///< the result by channel: kBlockHeight rows of kBlockWidth
};

/// Denoises the block whose upper left pixel is (x0, y0); the block may extend beyond the film. A pixel's result
/// depends on its neighbours alone, not on the block. The same bits on all processors with fused multiply-add.
void denoiseBlock(const DenoisePlanes& planes, int x0, int y0, DenoiseScratch& scratch);

}  // namespace stratum::shade
