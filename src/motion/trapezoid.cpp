#include "motion/trapezoid.h"

#include <algorithm>
#include <cmath>

namespace stratum::motion {

Trapezoid fastest(double length, double acceleration, double entry_squared, double most_squared, double exit_squared) {
    // A profile without a cruising phase: half the sum of the squared speeds, plus acceleration times length.
    const double meeting = 0.5 * (entry_squared + exit_squared) + acceleration * length;
    const bool cruises = most_squared < meeting;
    const double peak_squared = std::max({entry_squared, exit_squared, cruises ? most_squared : meeting});
    Trapezoid result;
    result.entry = std::sqrt(entry_squared);
    result.exit = std::sqrt(exit_squared);
    result.peak = std::sqrt(peak_squared);
    result.acceleration = acceleration;
    result.rising = (result.peak - result.entry) / acceleration;
    result.falling = (result.peak - result.exit) / acceleration;
    if (!cruises || !(result.peak > 0)) return result;
    const double rest = length - (peak_squared - 0.5 * (entry_squared + exit_squared)) / acceleration;
    result.cruising = std::max(rest, 0.0) / result.peak;
    return result;
}

}  // namespace stratum::motion
