// The speed along one piece of motion: up with constant acceleration, on at one speed, down again.
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

/// The fastest way over `length` mm between squared speeds that the acceleration can join, never above the squared
/// speed `most`. Speeds mm/s, squared.
Trapezoid fastest(double length, double acceleration, double entry_squared, double most_squared, double exit_squared);

}  // namespace stratum::motion
