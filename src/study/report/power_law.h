// y = a x^b through measured points.
#pragma once

#include <cmath>
#include <span>
#include <utility>

namespace stratum::study {

struct PowerLaw {
    double factor = 0;
    double exponent = 0;
    double worst = 0;  ///< the largest |fitted / measured - 1| of the points it was fitted to

    double at(double x) const { return factor * std::pow(x, exponent); }
};

/// Least squares of log y over log x. Points (x, y), both above 0, at two or more different x; otherwise the law is
/// all NaN.
PowerLaw fitPowerLaw(std::span<const std::pair<double, double>> points);

}  // namespace stratum::study
