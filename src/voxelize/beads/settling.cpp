#include "voxelize/beads/settling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace stratum::voxelize {
namespace {

// All in radii, for 0 <= d <= 1.
double root(double d) { return std::sqrt(std::max(1 - d * d, 0.0)); }
double depth(double d) { return 2 - 2 * root(d); }
// int_0^d sqrt(1 - t^2) dt
double quarterDisc(double d) { return 0.5 * (d * root(d) + std::asin(d)); }
// int_0^d V
double depthIntegral(double d) { return 2 * d - 2 * quarterDisc(d); }

}  // namespace

SettlingCurve::SettlingCurve(double ratio, double weld_gap)
    : ratio_(ratio),
      // E = C, solved for m: the integrals of the root cancel.
      closing_(1 - (2 - 0.5 * std::numbers::pi) / ratio),
      weld_level_(std::min(1.0, std::sqrt(1 - std::pow(std::max(1 - 0.5 * weld_gap * ratio, 0.0), 2)))) {
    table_.reserve(kSteps + 1);
    for (int n = 0; n <= kSteps; ++n) {
        const double from_one = 1 - static_cast<double>(n) / kSteps;
        const double root_q = 1 - from_one * from_one;
        table_.push_back(static_cast<float>(level(closing_ + (1 - closing_) * root_q * root_q)));
    }
}

double SettlingCurve::level(double m) const {
    if (m <= closing_) return 0;
    if (m >= 1) return 1;
    const double quarter = 0.25 * std::numbers::pi;
    const double claimed = (ratio_ - 2) * (1 - m) + 2 * (quarter - quarterDisc(m));
    const double whole = depthIntegral(m);
    double low = 0;
    double high = m;
    // The filled area falls monotonically with the level. Bisection: the slope is 0 at both ends.
    constexpr int kBisections = 52;
    for (int n = 0; n < kBisections; ++n) {
        const double middle = 0.5 * (low + high);
        const double filled = whole - depthIntegral(middle) - (m - middle) * depth(middle);
        (filled > claimed ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

double settlingScale(const gcode::Toolpath& toolpath) {
    constexpr double kUsual = 0.4;  // mm
    double lowest = std::numeric_limits<double>::infinity();
    for (const gcode::Run& run : toolpath.runs)
        if (run.height > 0) lowest = std::min(lowest, static_cast<double>(run.height));
    constexpr double kRounding = 1e-6;  // heights are floats
    return std::isfinite(lowest) && lowest > kUsual * (1 + kRounding) ? lowest / kUsual : 1;
}

}  // namespace stratum::voxelize
