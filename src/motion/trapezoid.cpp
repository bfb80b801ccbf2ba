#include "motion/trapezoid.h"

#include <algorithm>
#include <cmath>

namespace stratum::motion {

Trapezoid fastest(double length, double acceleration, double entry_squared, double most_squared, double exit_squared) {
    // A profile without a cruising phase: half the sum of the squared speeds, plus acceleration times length.
    const double meeting = 0.5 * (entry_squared + exit_squared) + acceleration * length;
    Trapezoid result =
        throughPeak(length, acceleration, entry_squared,
                    std::max({entry_squared, exit_squared, std::min(most_squared, meeting)}), exit_squared);
    if (most_squared >= meeting) result.cruising = 0;
    return result;
}

Trapezoid throughPeak(double length, double acceleration, double entry_squared, double peak_squared,
                      double exit_squared) {
    Trapezoid result;
    result.entry = std::sqrt(entry_squared);
    result.exit = std::sqrt(exit_squared);
    result.peak = std::sqrt(peak_squared);
    result.acceleration = acceleration;
    result.rising = (result.peak - result.entry) / acceleration;
    result.falling = (result.peak - result.exit) / acceleration;
    if (!(result.peak > 0)) return result;
    const double rest = length - (peak_squared - 0.5 * (entry_squared + exit_squared)) / acceleration;
    result.cruising = std::max(rest, 0.0) / result.peak;
    return result;
}

Trapezoid partOf(const Trapezoid& whole, double from, double to) {
    const double risen = 0.5 * (whole.entry + whole.peak) * whole.rising;
    const double cruised = risen + whole.peak * whole.cruising;
    const auto speedAt = [&](double way) {
        double squared = whole.peak * whole.peak;
        if (way < risen) squared = whole.entry * whole.entry + 2 * whole.acceleration * way;
        if (way > cruised) squared -= 2 * whole.acceleration * (way - cruised);
        return std::clamp(std::sqrt(std::max(squared, 0.0)), way > cruised ? whole.exit : whole.entry, whole.peak);
    };
    Trapezoid part;
    part.acceleration = whole.acceleration;
    part.entry = speedAt(from);
    part.exit = speedAt(to);
    part.peak = from <= cruised && to >= risen ? whole.peak : std::max(part.entry, part.exit);
    part.rising = from < risen ? (part.peak - part.entry) / whole.acceleration : 0;
    part.falling = to > cruised ? (part.peak - part.exit) / whole.acceleration : 0;
    part.cruising = whole.peak > 0 ? std::max(std::min(to, cruised) - std::max(from, risen), 0.0) / whole.peak : 0;
    return part;
}

}  // namespace stratum::motion
