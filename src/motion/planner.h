// The planner of a firmware: from the moves of a program to the speed at every moment.
//
// Look-ahead is exact as long as it can be: a corner speed is settled when no later move can change it, which is where
// even a stop right behind the last known move leaves it at what the corner allows. Only programs that brake over more
// than kMostPending pieces at a stretch are planned as if they had to be able to stop after so many, as every real
// firmware with its 16 to 1000 pieces plans.
// Sources: as of corner.h; for the passes, any of those firmwares; klipper3d.org/Kinematics.html ("look-ahead",
// "smoothed look-ahead") for minimum_cruise_ratio.
#pragma once

#include "gcode/machine/motion.h"
#include "motion/corner.h"
#include "motion/segment.h"
#include "motion/trapezoid.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace stratum::motion {

/// A piece of motion with its speeds and its time: what flow and time are computed from.
struct PlannedPiece {
    double start = 0;  ///< s since the program's begin
    Trapezoid speed;
    Segment segment;
};

/// Takes the plan, in order, a piece at a time.
class PlanSink {
public:
    PlanSink() = default;
    PlanSink(const PlanSink&) = delete;
    PlanSink& operator=(const PlanSink&) = delete;
    virtual ~PlanSink() = default;

    virtual void piece(const PlannedPiece& piece) = 0;
    /// The machine stands from `start` on for `seconds`.
    virtual void wait(double start, double seconds) = 0;
};

class Planner : public gcode::MotionSink {
public:
    static constexpr std::size_t kMostPending = std::size_t{1} << 15;

    /// The sink must outlive the planner.
    explicit Planner(PlanSink& sink) : sink_(sink) {}

    void limits(const gcode::MachineLimits& limits) override { limits_ = limits; }
    void move(const gcode::Move& move) override;
    void wait(double seconds) override;
    /// The program is over: plans what is left. Called once.
    void finish() { wait(0); }

    double seconds() const { return time_; }
    /// The rule in force at the end.
    gcode::CornerRule rule() const { return limits_.rule; }

private:
    // Speeds squared, mm^2/s^2.
    struct Pending {
        Segment segment;
        double entry_most = 0;   // what corner and acceleration since the last stop allow
        double smooth_most = 0;  // the same for Klipper's smoothed look-ahead
        double gain = 0;         // 2 a d
        double smooth_gain = 0;
        double entry = 0;
        double smooth_entry = 0;
        double peak_most = 0;
    };

    void add(const Segment& segment);
    // Entry speeds for an end at these speeds; returns how many pieces at the front no later piece can change.
    std::size_t lookBack(double exit_squared);
    void smoothPeaks(std::size_t count);
    void settle(std::size_t count, double exit_squared);

    PlanSink& sink_;
    gcode::MachineLimits limits_;
    std::vector<Pending> pending_;
    std::size_t first_ = 0;  // of the pending ones; those before are settled
    std::size_t next_look_ = 0;
    std::vector<std::size_t> braking_;
    bool at_rest_ = true;
    bool smooth_ = false;
    Segment last_;
    gcode::MachineLimits last_limits_;
    double time_ = 0;
};

}  // namespace stratum::motion
