// A smooth curve through given values that never leaves the range of two neighbours.
#pragma once

#include <vector>

namespace stratum::animate {

/// A cubic Hermite spline with continuous slopes, monotone between values. It passes exactly through all of them; with
/// two it is straight, with one constant. Slopes: F. N. Fritsch, J. Butland, "A Method for Constructing Local Monotone
/// Piecewise Cubic Interpolants", SIAM J. Sci. Stat. Comput. 5 (1984), in the form of Brodlie that weighs by lengths.
class MonotoneCubic {
public:
    /// @param places  ascending, at least one
    /// @param values  as many
    MonotoneCubic(std::vector<double> places, std::vector<double> values);
    /// The first or the last value outside of the places.
    double operator()(double place) const;

private:
    std::vector<double> places_, values_, slopes_;
};

}  // namespace stratum::animate
