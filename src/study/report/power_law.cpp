#include "study/report/power_law.h"

#include <algorithm>
#include <limits>

namespace stratum::study {

PowerLaw fitPowerLaw(std::span<const std::pair<double, double>> points) {
    const auto count = static_cast<double>(points.size());
    double mean_x = 0;
    double mean_y = 0;
    for (const auto& [x, y] : points) {
        mean_x += std::log(x) / count;
        mean_y += std::log(y) / count;
    }
    double xx = 0;
    double xy = 0;
    for (const auto& [x, y] : points) {
        xx += (std::log(x) - mean_x) * (std::log(x) - mean_x);
        xy += (std::log(x) - mean_x) * (std::log(y) - mean_y);
    }
    if (!(xx > 0) || !std::isfinite(xy)) {
        constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
        return {kNone, kNone, kNone};
    }
    PowerLaw law;
    law.exponent = xy / xx;
    law.factor = std::exp(mean_y - law.exponent * mean_x);
    for (const auto& [x, y] : points) law.worst = std::max(law.worst, std::abs(law.at(x) / y - 1));
    return law;
}

}  // namespace stratum::study
