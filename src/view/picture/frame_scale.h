// How large pictures may be while a view moves: as large as they can be in the time of a frame.
#pragma once

#include <algorithm>
#include <cmath>

namespace stratum::view {

/// Follows the cost of a pixel, which changes with what is in front of the camera.
class FrameScale {
public:
    /// @param seconds  that a frame may take
    explicit FrameScale(double seconds) : seconds_(seconds) {}

    /// Of each side, in steps of a sixteenth, from kLeast to 1.
    double scale(int width, int height) const {
        const double pixels = static_cast<double>(width) * static_cast<double>(height);
        const double side = std::sqrt(seconds_ / (cost_ * pixels));
        return std::clamp(std::floor(side * 16.0) / 16.0, kLeast, 1.0);
    }
    /// A frame of so many pixels took so long. A frame for which bricks had to be made tells of the next ones, too: so
    /// rises are believed sooner than falls.
    void took(double pixels, double seconds) {
        const double cost = std::clamp(seconds / std::max(1.0, pixels), 1e-9, 1e-3);
        const double share = cost > cost_ ? 0.5 : 0.25;
        cost_ += share * (cost - cost_);
    }

    static constexpr double kLeast = 0.1875;

private:
    double seconds_;
    double cost_ = 4e-7;  // seconds a pixel; before the first frame
};

}  // namespace stratum::view
