// The inner loops of denoise(): one block of pixels at a time, in the lanes of vectors.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace stratum::shade {

/// The numbers of the estimator; denoise.h says what they belong to.
struct Denoising {
    static constexpr int kRadius = 7;      ///< pixels: how far neighbours may be
    static constexpr int kPatch = 2;       ///< pixels about each of the two that are compared
    static constexpr float kLight = 0.6f;  ///< how much larger than the noise a difference of light may be (Rousselle)
    /// Ridge of the regression, relative to the sum of weights: a guide whose standard deviation is less than the root
    /// of this is not to be trusted.
    static constexpr float kRidge = 3e-5f;
    /// The weight of a distance d is max(0, 1 - d / 8)^8: close to exp(-d), and ends.
    static constexpr float kEnd = 8.0f;
};

/// A film as planes of floats with a mirrored margin, so that loops need not ask where it ends.
class DenoisePlanes {
public:
    enum Plane {
        brightness,
        variance,   // of the mean luminance
        closeness,  // kCloseness planes: the squared differences of all are the distance of two pixels in guides
        terms = closeness + 7,  // kTerms planes: what the light is taken to be a linear function of, beside the place
        color = terms + 3,      // 3 planes
        kPlanes = color + 3
    };
    static constexpr int kCloseness = 7;
    static constexpr int kTerms = 3;
    static constexpr int kBlockWidth = 64, kBlockHeight = 16;  // pixels
    static constexpr int kMargin = 16;                         // pixels, left and above; more on the other sides

    DenoisePlanes(int width, int height);
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

/// What a thread needs for a block.
struct DenoiseScratch {
    std::vector<float> weights;                ///< of each neighbour, of each pixel
    std::array<std::vector<float>, 3> colors;  ///< the result: kBlockHeight rows of kBlockWidth
};

/// Denoises the block whose upper left pixel is (x0, y0); the block may reach beyond the film. A pixel's result depends
/// on its neighbours alone, not on the block. The same bits on all processors that can multiply and add in one step.
void denoiseBlock(const DenoisePlanes& planes, int x0, int y0, DenoiseScratch& scratch);

}  // namespace stratum::shade
