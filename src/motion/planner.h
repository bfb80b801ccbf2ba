// A firmware's motion planner: computes the speed at every moment from the moves of a program.
//
// Look-ahead is exact: a corner speed is final when no later move can change it, that is, when it is the corner's limit
// even if the machine had to stop right after the last known move. Only programs that decelerate over more than
// kMostPending consecutive segments are planned with a stop after so many, as in real firmware with its 16 to 1000
// segments.
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

/// A segment of motion with its speeds and its time, from which flow and times are computed.
struct PlannedPiece {
    double start = 0;  ///< s since the program's begin
    Trapezoid speed;
    Segment segment;
};

/// Receives the plan, in order, one segment at a time.
class PlanSink {
public:
    PlanSink() = default;
    PlanSink(const PlanSink&) = delete;
    PlanSink& operator=(const PlanSink&) = delete;
    virtual ~PlanSink() = default;

    virtual void piece(const PlannedPiece& piece) = 0;
    /// The machine waits from `start` on for `seconds`.
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
    /// End of the program: plans the remaining segments. Called once.
    void finish() { wait(0); }

    double seconds() const { return time_; }
    /// The rule at the end of the program.
    gcode::CornerRule rule() const { return limits_.rule; }

private:
    // Speeds squared, mm^2/s^2.
    struct Pending {
        Segment segment;
        double entry_most = 0;   // limit of the corner and of acceleration since the last stop
        double smooth_most = 0;  // the same for Klipper's smoothed look-ahead
        double gain = 0;         // 2 a d
        double smooth_gain = 0;
        double entry = 0;
        double smooth_entry = 0;
        double peak_most = 0;
    };

    void add(const Segment& segment);
    // Computes entry speeds for an end at these speeds; returns how many segments at the front are final.
    std::size_t lookBack(double exit_squared);
    void smoothPeaks(std::size_t count);
    void settle(std::size_t count, double exit_squared);

    PlanSink& sink_;
    gcode::MachineLimits limits_;
    std::vector<Pending> pending_;
    std::size_t first_ = 0;  // the first pending one; those before are final
    std::size_t next_look_ = 0;
    std::vector<std::size_t> braking_;
    bool at_rest_ = true;
    bool smooth_ = false;
    Segment last_;
    gcode::MachineLimits last_limits_;
    double time_ = 0;
};

}  // namespace stratum::motion
