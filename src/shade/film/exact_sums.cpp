#include "shade/film/exact_sums.h"

#include <utility>

namespace stratum::shade {

void ExactSums::carry(std::size_t n, double error) {
    for (std::vector<double>& plane : more_) {
        error = addTo(plane[n], error);
        if (!(std::abs(error) > 0.0)) return;
    }
    growTo(planes() + 1);
    more_.back()[n] = error;
}

/// J. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997, rounded once
/// as math.fsum of Python does.
double ExactSums::rounded(std::size_t n) const {
    // A sum of two doubles is rounded once already.
    if (more_.size() == 1 || !std::isfinite(first_[n])) return first_[n] + more_[0][n];
    std::vector<double> parts;  // from small to large; they don't overlap, and add up to the sum
    for (std::size_t k = 0; k < planes(); ++k) {
        double x = plane(k)[n];
        if (x == 0.0) continue;
        std::size_t kept = 0;
        for (double y : parts) {
            if (std::abs(x) < std::abs(y)) std::swap(x, y);
            const double high = x + y;
            const double low = y - (high - x);
            if (low != 0.0) parts[kept++] = low;
            x = high;
        }
        parts.resize(kept);
        parts.push_back(x);
    }
    if (parts.empty()) return 0.0;
    std::size_t left = parts.size() - 1;
    double high = parts[left];
    double low = 0.0;
    while (left > 0 && low == 0.0) {
        const double x = high;
        const double y = parts[--left];
        high = x + y;
        low = y - (high - x);
    }
    // What was rounded may have been half a unit, which the next part makes more than half.
    if (left > 0 && low != 0.0 && (low < 0.0) == (parts[left - 1] < 0.0)) {
        const double twice = 2.0 * low;
        const double other = high + twice;
        if (other - high == twice) high = other;
    }
    return high;
}

}  // namespace stratum::shade
