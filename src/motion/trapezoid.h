// The trapezoidal speed profile of one segment: constant acceleration, constant speed, constant deceleration.
#pragma once

namespace stratum::motion {

/// Seconds and mm/s. Any phase may last 0 s.
struct Trapezoid {
    double entry = 0;         ///< mm/s
    double peak = 0;          ///< mm/s
    double exit = 0;          ///< mm/s
    double acceleration = 0;  ///< mm/s^2, > 0, up and down
    double rising = 0;        ///< s
    double cruising = 0;      ///< s
    double falling = 0;       ///< s

    double seconds() const { return rising + cruising + falling; }
};

/// Planners compare speeds squared: these change by twice the acceleration a mm.
inline double squared(double speed) { return speed * speed; }

/// The fastest profile over `length` mm between two speeds that the acceleration can connect, never above `most`.
/// Speeds are squared, (mm/s)^2.
Trapezoid fastest(double length, double acceleration, double entry_squared, double most_squared, double exit_squared);

/// The profile through a given peak, which must be at least both ends and must leave room to reach them. Speeds are
/// squared, (mm/s)^2.
Trapezoid throughPeak(double length, double acceleration, double entry_squared, double peak_squared,
                      double exit_squared);

/// The part of a profile between two distances from its begin, mm; 0 <= from <= to <= its length.
Trapezoid partOf(const Trapezoid& whole, double from, double to);

}  // namespace stratum::motion
