#include "animate/monotone_cubic.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace stratum::animate {
namespace {

// At the end of a curve: that of a parabola through three values, as far as it stays monotone.
double endSlope(double h0, double h1, double d0, double d1) {
    const double slope = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
    if (!(slope * d0 > 0)) return 0;
    if (!(d0 * d1 > 0) && std::abs(slope) > 3 * std::abs(d0)) return 3 * d0;
    return slope;
}

}  // namespace

MonotoneCubic::MonotoneCubic(std::vector<double> places, std::vector<double> values)
    : places_(std::move(places)), values_(std::move(values)), slopes_(values_.size(), 0.0) {
    const std::size_t count = values_.size();
    if (count < 2) return;
    std::vector<double> lengths;
    std::vector<double> rises;
    lengths.reserve(count - 1);
    rises.reserve(count - 1);
    for (std::size_t n = 0; n + 1 < count; ++n) {
        lengths.push_back(places_[n + 1] - places_[n]);
        rises.push_back((values_[n + 1] - values_[n]) / lengths[n]);
    }
    if (count == 2) {
        slopes_ = {rises[0], rises[0]};
        return;
    }
    for (std::size_t n = 1; n + 1 < count; ++n) {
        const double before = rises[n - 1];
        const double after = rises[n];
        if (!(before * after > 0)) continue;  // it turns here
        const double share = (lengths[n - 1] + 2 * lengths[n]) / (3 * (lengths[n - 1] + lengths[n]));
        slopes_[n] = 1 / (share / before + (1 - share) / after);
    }
    slopes_.front() = endSlope(lengths[0], lengths[1], rises[0], rises[1]);
    slopes_.back() = endSlope(lengths[count - 2], lengths[count - 3], rises[count - 2], rises[count - 3]);
}

double MonotoneCubic::operator()(double place) const {
    if (!(place > places_.front())) return values_.front();
    if (!(place < places_.back())) return values_.back();
    const auto next =
        static_cast<std::size_t>(std::upper_bound(places_.begin(), places_.end(), place) - places_.begin());
    const std::size_t n = next - 1;
    const double length = places_[next] - places_[n];
    const double t = (place - places_[n]) / length;
    const double rest = 1 - t;
    // Hermite's form, with the value at a place itself exact.
    return values_[n] + t * t * (3 - 2 * t) * (values_[next] - values_[n]) +
           length * t * rest * (rest * slopes_[n] - t * slopes_[next]);
}

}  // namespace stratum::animate
